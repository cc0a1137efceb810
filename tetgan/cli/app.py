"""The command, with the arguments and option readers that its subcommands share."""

import os
from pathlib import Path
from typing import Annotated, Any

import typer
import yaml

from tetgan.errors import UserError
from tetgan.options import parse_options

app = typer.Typer(
    help="Learned tetrahedral mesh generation, one stage a command.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback()
def load_models(
    plugin: Annotated[
        list[str] | None,
        typer.Option(
            envvar="TETGAN_PLUGINS",
            help="Importable module with further kinds of model; naming one runs its code. May be repeated.",
        ),
    ] = None,
) -> None:
    from tetgan.models.registry import load_plugins

    load_plugins(plugin or [])


OptionsText = Annotated[str, typer.Option(help="Options as JSON, or the path of a YAML or JSON file.")]

Category = Annotated[str, typer.Option(help="Category, such as chair.")]

Seed = Annotated[int, typer.Option(min=0, help="Seed of every random choice.")]

Threads = Annotated[int, typer.Option(min=1, help="Processor cores to use.")]

Metrics = Annotated[list[Path], typer.Argument(help="Metrics (.json) of models and of real shapes.")]

TableOut = Annotated[Path, typer.Argument(help="Table (.csv) to write; with a .md twin.")]

Paper = Annotated[Path, typer.Option(help="The paper's published figures (.csv).")]

Margin = Annotated[float, typer.Option(min=0, max=0.49, help="Empty share of the cube on either side.")]


def read_plain(text: str, name: str) -> dict[str, Any]:
    """A mapping from JSON text or from a YAML or JSON file."""
    source = text
    if not text.lstrip().startswith("{"):
        if not Path(text).is_file():
            raise UserError(f"{name}: '{text}' is neither a JSON object nor a file")
        source = Path(text).read_text()
    try:
        values = yaml.safe_load(source)
    except yaml.YAMLError as error:
        raise UserError(f"{name}: not valid YAML or JSON: {error}") from None
    if not isinstance(values, dict):
        raise UserError(f"{name}: expected keys and values, got {values!r}")
    return values


def read_options(kind: Any, text: str, name: str) -> Any:
    return parse_options(kind, read_plain(text, name), name)


def split_ids(text: str, count: int, name: str) -> Any:
    """Ids of shapes, joined by colons: an id has none."""
    ids = tuple(text.split(":"))
    if len(ids) != count or not all(ids):
        raise UserError(f"{name}: '{text}' is not {count} ids joined by colons")
    return ids


def use_threads(count: int) -> None:
    import torch

    from tetgan.nn.device import keep_freed_memory

    keep_freed_memory()
    torch.set_num_threads(count)


def limit_libigl(threads: int) -> None:
    """Call it before libigl is imported: it reads its number of threads then, and else takes every core."""
    os.environ["IGL_NUM_THREADS"] = str(threads)
