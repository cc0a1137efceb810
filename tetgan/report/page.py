"""Stage: the whole page."""

import base64
import hashlib
import logging
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path
from typing import Any

import pandas as pd
import yaml
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.report.figures import read_figures
from tetgan.report.markup import table_html
from tetgan.report.provenance import (
    code_commit,
    machine,
    package_versions,
    seeds_of,
    stage_times,
    training_devices,
)
from tetgan.report.solids import REGULAR_DIHEDRAL, find_sample_sets, pack_sets
from tetgan.report.tables import read_tables

_TEMPLATE = files("tetgan.report") / "template"

MOST_BYTES = 15_000_000
"""A larger page is written too, with a warning."""

log = logging.getLogger(__name__)


def report_page(
    results: Path,
    out: Path,
    *,
    config: Mapping[str, Any],
    captions: Path | None,
    models: Sequence[str] = (),
    samples: int = 4,
) -> None:
    """Write every table and figure of a run, solids to turn and cut, and the provenance into one HTML file.

    Args:
        results: folder with `tables/`, `figures/`, `samples/`, `models/`, `benchmarks/`; each may be missing.
        config: the configuration of the run, shown in full.
        captions: folder of `{name}.rst` (see `read_caption`).
        models: whose solids are shown; empty for every model's.
        samples: solids of each.

    Raises:
        UserError: there is neither a table nor a figure, or a file cannot be read.
    """
    categories = list(config.get("categories") or sorted(config.get("sources") or ()))
    tables = read_tables(results, categories, captions, config)
    figures = read_figures(results, categories, captions, config)
    if not tables and not figures:
        raise UserError(f"{results}: no tables/*.csv and no figures/**/*.png to report; make them first")
    page = render_page(
        title=f"TetGAN: {config['run']}" if config.get("run") else "TetGAN: results",
        tables=tables,
        figures=figures,
        solids=pack_sets(find_sample_sets(results / "samples", models, samples)),
        latest=_latest(results),
        provenance=_provenance(results, config),
        config=yaml.safe_dump(dict(config), sort_keys=False, allow_unicode=True, width=100) if config else "",
    )
    content = page.encode()
    with whole_file(out) as partial:
        partial.write_bytes(content)
    level = logging.WARNING if len(content) > MOST_BYTES else logging.INFO
    log.log(level, "%s: %d tables, %d figures, %.1f MB", out, len(tables), len(figures), len(content) / 1e6)


def render_page(**content: Any) -> str:
    """The page's HTML. Its one script is named by its digest, so a browser runs no other."""
    environment = Environment(
        loader=PackageLoader("tetgan.report", "template"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    style, script = (_TEMPLATE.joinpath(name).read_text("utf-8") for name in ("page.css", "viewer.js"))
    return environment.get_template("page.html").render(
        style=Markup(style),
        script=Markup(script),
        script_digest=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
        regular_dihedral=REGULAR_DIHEDRAL,
        **content,
    )


def _latest(results: Path) -> str:
    """Day and time, UTC, of the newest table or figure."""
    shown = [*results.glob("tables/*.csv"), *results.glob("figures/**/*.png")]
    newest = max(path.stat().st_mtime for path in shown)
    return datetime.fromtimestamp(newest, UTC).strftime("%Y-%m-%d %H:%M UTC")


def _provenance(results: Path, config: Mapping[str, Any]) -> dict[str, Markup]:
    """Title and table of each part of the provenance."""
    stages = stage_times(results / "benchmarks")
    return {
        "Code and machine that made this page": _pairs({"commit": code_commit(), **machine()}),
        "Seeds": _pairs(seeds_of(config)),
        "Devices of training": _pairs(_by_device(training_devices(results))),
        "Time of each stage": _times(stages),
        "Packages": _pairs(package_versions()),
    }


def _by_device(devices: Mapping[str, str]) -> dict[str, str]:
    """Models of each device; most runs have one."""
    grouped: dict[str, list[str]] = {}
    for model, device in devices.items():
        grouped.setdefault(device or "not recorded", []).append(model)
    return {device: ", ".join(models) for device, models in grouped.items()}


def _pairs(values: Mapping[str, str]) -> Markup:
    if not values:
        return Markup("<p>None known.</p>")
    return table_html(["what", "value"], list(values.items()), numbers=False)


def _times(stages: pd.DataFrame) -> Markup:
    if stages.empty:
        return Markup("<p>No benchmark files: the stages did not run under Snakemake.</p>")
    total = Markup("<p>{:.1f} minutes of jobs in all; jobs run side by side.</p>").format(
        stages["minutes"].sum()
    )
    rows = [
        [str(row.stage), str(row.jobs), f"{row.minutes:.2f}", f"{row.longest:.2f}", _mebibytes(row.peak)]
        for row in stages.itertuples()
    ]
    return table_html(["stage", "jobs", "minutes", "longest job", "peak memory of a job, MiB"], rows) + total


def _mebibytes(value: Any) -> str:
    return "" if pd.isna(value) else f"{value:.0f}"
