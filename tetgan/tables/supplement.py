"""Stage: one figure of every category side by side, as in the three tables of the paper's supplement."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.errors import UserError
from tetgan.evaluation.metrics import BY_NAME
from tetgan.tables.markdown import cell, markdown_table, page, plain, row_name, write_twins
from tetgan.tables.notes import extractor_notes, remarks
from tetgan.tables.paper import read_paper
from tetgan.tables.rows import (
    estimates_of,
    group_reports,
    identity_cells,
    metric_cells,
    printed_figures,
    read_reports,
    with_whole_counts,
)

FIGURES = {"fid": "fid", "variety": "variety", "reconstruction": "chamfer"}
"""The paper's table and its metric."""

IDENTITY = ("model", "grid", "tets", "mode", "smoothing", "simplified", "reduced", "extractor")

_SUBJECTS = {"fid": "samples", "variety": "samples", "reconstruction": "reconstructions"}

_ABOUT_PAPER = (
    "The paper's figures are in parentheses as printed: benches and vases are its high-resolution models, "
    "sofas and tables its low-resolution ones, and it does not say whether they were smoothed; those of "
    "chairs are from its Table 1. They were measured on other shapes, at the paper's sizes and with another "
    "extractor: they are no claim of equal conditions."
)


def tabulate_supplement(metrics: Sequence[Path], paper: Path, figure: str, out: Path) -> None:
    """Write the table as CSV, and as Markdown beside it.

    One row a model, mode and smoothing. Missing is empty, never 0.

    Args:
        metrics: JSONs of `evaluate_model` and `evaluate_real`, of any categories.
        paper: published figures (`tetgan.tables.paper`).
        figure: a key of `FIGURES`.
        out: `.csv` to write.

    Raises:
        UserError: no metrics, or no such figure.
    """
    if figure not in FIGURES:
        raise UserError(f"figure '{figure}': choose one of {', '.join(FIGURES)}")
    reports = read_reports(metrics, out)
    figures = read_paper(paper)
    categories = _categories(reports, figures, figure)
    table = build_supplement(reports, figures, FIGURES[figure], categories)
    write_twins(table, _render(table, reports, figure, categories), out)


def _categories(reports: Sequence[Mapping[str, Any]], paper: pd.DataFrame, figure: str) -> list[str]:
    """Those of the paper's table, run or not, then all others that were run."""
    printed = paper.loc[paper["table"].str.casefold() == f"supplement {figure}", "category"]
    return list(dict.fromkeys([*sorted(printed), *(report["category"] for report in reports)]))


def build_supplement(
    reports: Sequence[Mapping[str, Any]], paper: pd.DataFrame, metric: str, categories: Sequence[str]
) -> pd.DataFrame:
    """For each category c the columns c, c_std, c_low, c_high, c_n, c_paper and c_seeds, after `IDENTITY`.

    `c_n` counts the items that the figure rests on: meshes, or for FID the surfaces on each side.
    """
    rows = []
    for smoothing, members in group_reports(reports):
        identity = identity_cells(members, smoothing)
        row = {name: identity[name] for name in IDENTITY}
        for category in categories:
            printed = printed_figures(paper, category, members, smoothing).get(metric)
            own = [member for member in members if member["category"] == category]
            row |= _category_cells(category, estimates_of(own, smoothing, metric), printed)
        rows.append(row)
    return with_whole_counts(pd.DataFrame(rows))


def _category_cells(
    category: str, estimates: Sequence[Mapping[str, Any]], printed: str | None
) -> dict[str, Any]:
    measured = [estimate for estimate in estimates if estimate.get("value") is not None]
    return metric_cells(category, estimates, printed) | {f"{category}_seeds": len(measured) or None}


def _render(
    table: pd.DataFrame, reports: Sequence[Mapping[str, Any]], figure: str, categories: Sequence[str]
) -> str:
    cells = {category: table.apply(cell, axis=1, metric=category) for category in categories}
    names = {"Model": table.apply(row_name, axis=1)}
    counts = {f"{category}: N": table[f"{category}_n"].map(plain) for category in categories}
    made = {
        "Grid": table["grid"].map(plain),
        **counts,
        "Other than the paper's": table["reduced"].map(plain),
    }
    return page(
        f"{BY_NAME[FIGURES[figure]].heading} of {_SUBJECTS[figure]}",
        _ABOUT_PAPER,
        markdown_table(names | cells),
        "## How each row was made",
        markdown_table(names | made),
        notes=_notes(reports, figure, categories),
    )


def _notes(reports: Sequence[Mapping[str, Any]], figure: str, categories: Sequence[str]) -> list[str]:
    level = 100 * reports[0]["options"]["bootstrap"]["level"]
    of = {category: [r for r in reports if r["category"] == category] for category in categories}
    absent = [category for category, own in of.items() if not own]
    title = BY_NAME[FIGURES[figure]].title.casefold()
    found = (f"{category}: {remark}" for category, own in of.items() for remark in remarks(own))
    return [
        f"[…]: {level:g} % intervals; ±: over seeds, or for one seed over repeats (variety). "
        "docs/metrics.md defines every metric.",
        *([f"Not run: {', '.join(absent)}."] if absent else []),
        *(extractor_notes(reports) if figure == "fid" else []),
        *(remark for remark in found if title in remark.casefold()),
    ]
