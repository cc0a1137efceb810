"""Stage: the metrics of a category in one table, the paper's figures beside ours."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.evaluation.metrics import BY_NAME, GROUPS, headings_of, names_of
from tetgan.tables.markdown import markdown_table, metric_columns, page, plain, row_name, write_twins
from tetgan.tables.notes import table_notes
from tetgan.tables.paper import read_paper
from tetgan.tables.rows import (
    IDENTITY,
    METRIC_PARTS,
    estimates_of,
    group_reports,
    identity_cells,
    metric_cells,
    printed_figures,
    read_reports,
    with_whole_counts,
)

_SHOWN = ("reconstruction", "meshes", "features", "sets", "samples")  # groups of metrics

COLUMNS = tuple(sorted(names_of(*_SHOWN), key=lambda name: not BY_NAME[name].in_paper))
"""Metrics in the order of the columns: the paper's Table 1 first."""

_MADE = {
    "grid": "Grid",
    "tets": "Tets",
    "mode": "Mode",
    "seeds": "Seeds",
    "n": "Surfaces",
    "train_minutes": "Training, min",
    "reduced": "Other than the paper's",
}

_ABOUT_PAPER = (
    "The paper's figures are in parentheses as printed. They were measured on other shapes (ShapeNet, "
    "COSEG), at the paper's sizes and with another extractor: they are no claim of equal conditions. Its "
    "text also gives 98.9 % manifold edges for its ground-truth chairs and 98.5 % for generated ones."
)


def tabulate_category(metrics: Sequence[Path], paper: Path, category: str, out: Path) -> None:
    """Write the table as CSV, and as Markdown beside it.

    One row per model, mode and smoothing; several seeds of a model become one row. Missing is empty, never 0.

    Args:
        metrics: JSONs of `evaluate_model` and `evaluate_real`.
        paper: published figures (`tetgan.tables.paper`).
        category: theirs; metrics of another one are an error.
        out: `.csv` to write.

    Raises:
        UserError: no metrics, or metrics of another category.
    """
    reports = read_reports(metrics, out, category)
    table = build_table(reports, read_paper(paper), category)
    write_twins(table, render_table(table, reports, category), out)


def build_table(reports: Sequence[Mapping[str, Any]], paper: pd.DataFrame, category: str) -> pd.DataFrame:
    """Rows in the order of the paper, then the bounds: representation, PCA, real shapes."""
    rows = [
        _row(members, smoothing, printed_figures(paper, category, members, smoothing))
        for smoothing, members in group_reports(reports)
    ]
    columns = [
        *IDENTITY,
        *(f"{m}{part}" for m in COLUMNS for part in METRIC_PARTS),
    ]
    table = pd.DataFrame(rows, columns=columns)
    return with_whole_counts(table)


def _row(members: Sequence[Mapping[str, Any]], smoothing: str, paper: Mapping[str, str]) -> dict[str, Any]:
    row = identity_cells(members, smoothing)
    for metric in COLUMNS:
        row |= metric_cells(metric, estimates_of(members, smoothing, metric), paper.get(metric))
    return row


def render_table(table: pd.DataFrame, reports: Sequence[Mapping[str, Any]], category: str) -> str:
    """Markdown of a table made by `build_table` from those reports."""
    names = {"Model": table.apply(row_name, axis=1)}
    in_paper = [name for name in COLUMNS if BY_NAME[name].in_paper]
    return page(
        category,
        _ABOUT_PAPER,
        markdown_table(names | metric_columns(table, headings_of(in_paper))),
        "## Beyond the paper",
        *_groups(table, names),
        "## How each row was made",
        markdown_table(names | {title: table[column].map(plain) for column, title in _MADE.items()}),
        notes=table_notes(reports),
    )


def _groups(table: pd.DataFrame, names: Mapping[str, pd.Series]) -> Iterator[str]:
    """Heading and table of the metrics of every group that the paper does not have."""
    for group in _SHOWN:
        ours = [name for name in names_of(group) if not BY_NAME[name].in_paper]
        yield f"### {GROUPS[group]}"
        yield markdown_table({**names, **metric_columns(table, headings_of(ours))})
