"""Run every benchmark: figures beside their targets, cost against size, docs/performance.md.

python benchmarks/run.py            all, under twenty minutes on two cores; writes the files below
python benchmarks/run.py --quick    at toy sizes, to see that everything runs; only prints

A benchmark is a module here with `run(quick: bool) -> Records` (see records.py).
"""

import json
import logging
import os
import sys
from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer
from performance import draw_figures, table, write_page
from records import Record, Records, cpu_name, is_met
from rich.console import Console
from rich.progress import Progress

from tetgan.errors import UserError
from tetgan.files import whole_file

HERE = Path(__file__).parent
MODULES = ("start", "grids", "fields", "metrics", "sizes")
MODULES += ("conv", "step", "memory", "streaming", "solids", "simulation")

log = logging.getLogger("benchmarks")


def main(
    quick: Annotated[bool, typer.Option(help="toy sizes; writes nothing unless given a folder")] = False,
    only: Annotated[str, typer.Option(help="benchmarks to run, with commas; by default all")] = "",
    out: Annotated[Path | None, typer.Option(help="figures (.json); benchmarks/latest.json")] = None,
    page: Annotated[Path | None, typer.Option(help="page to bring up to date; docs/performance.md")] = None,
    threads: Annotated[int, typer.Option(min=1, help="processor cores to use")] = 2,
) -> None:
    """Measure, print, and write what was measured."""
    logging.basicConfig(level=logging.INFO, format="%(levelname).1s %(name)s: %(message)s")
    sys.path.append(str(HERE.parent))  # some say `from benchmarks.naive import`, as modules do
    use_threads(threads)
    chosen = tuple(only.split(",")) if only else MODULES
    found = measure(chosen, quick)
    typer.echo(table(found))
    missed = [name for name, each in found.items() if is_met(each) is False]
    said = f"{len(missed)} of {len(found)} figures miss their target"
    typer.echo("\n  ".join([said, *missed]))
    if out is None and not quick:
        out = HERE / "latest.json"
    if out is not None:
        found = merge(read_records(out), found, keep_all=bool(only))
        with whole_file(out) as partial:
            partial.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n")
    if page is None and not quick:
        page = HERE.parent / "docs" / "performance.md"
    if page is not None:
        write_page(page, found, draw_figures(found, page.parent / "images"))


def use_threads(count: int) -> None:
    """Call it before libigl is imported, which reads its number then."""
    os.environ["IGL_NUM_THREADS"] = str(count)
    import torch  # noqa: PLC0415

    torch.set_num_threads(count)


def measure(modules: tuple[str, ...], quick: bool) -> Records:
    """Figures of the modules that are here, in their order.

    Raises:
        UserError: a module is none of `MODULES`.
    """
    found: Records = {}
    # The benchmarks have bars of their own: this one is drawn between them.
    with Progress(console=Console(stderr=True), auto_refresh=False) as progress:
        task = progress.add_task("benchmarks", total=len(modules))
        for name in modules:
            if name not in MODULES:
                raise UserError(f"--only: '{name}' is not one of {', '.join(MODULES)}")
            progress.update(task, description=name, refresh=True)
            if (HERE / f"{name}.py").is_file():
                found |= _named_device(import_module(name).run(quick))
            else:
                log.warning("%s: not here, left out", name)
            progress.update(task, advance=1, refresh=True)
    return found


def _named_device(found: Records) -> Records:
    """A plain `cpu` says too little beside figures of other machines."""
    return {
        name: Record(**{**each, "device": cpu_name()}) if each["device"] == "cpu" else each
        for name, each in found.items()
    }


def merge(before: Records, found: Records, *, keep_all: bool) -> Records:
    """New figures over old ones; what was measured on other devices stays, unless measured anew.

    Args:
        keep_all: keep those of this processor, and computed ones, too: only some benchmarks ran.
    """
    anew = cpu_name(), "computed"
    kept = {name: each for name, each in before.items() if keep_all or each["device"] not in anew}
    return kept | found


def read_records(path: Path) -> Records:
    """What a file holds; nothing where there is none."""
    return json.loads(path.read_text()) if path.is_file() else {}


if __name__ == "__main__":
    try:
        typer.run(main)
    except UserError as error:
        sys.exit(f"error: {error}")
