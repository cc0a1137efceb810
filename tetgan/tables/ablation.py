"""Stage: ablations of TetGAN beside the full model."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.errors import UserError
from tetgan.evaluation.metrics import headings_of, names_of
from tetgan.tables.category import COLUMNS as CATEGORY_COLUMNS
from tetgan.tables.markdown import markdown_table, metric_columns, page, plain, row_name, write_twins
from tetgan.tables.notes import table_notes
from tetgan.tables.paper import read_paper
from tetgan.tables.rows import (
    IDENTITY,
    METRIC_PARTS,
    estimates_of,
    group_reports,
    identity_cells,
    is_real,
    metric_cells,
    printed_figures,
    read_reports,
    with_whole_counts,
)

COLUMNS = (*CATEGORY_COLUMNS, *names_of("solids"))
"""Metrics, in the order of the columns."""

_FIGURES = ("fid", "kid", "chamfer", "iou", "variety")

_SOLIDS = (*names_of("solids"), "inverted_tets", "manifold_edges", "faces", "empty_samples")

_MADE = {"changes": "Differs from the full model in", "train_minutes": "Training, min", "n": "Surfaces"}

_ABOUT = (
    "The full model first, then models that differ from it in what the last table says. The paper's figures "
    "are in parentheses: those of its Table 1 beside the full model, and the two that it published of its "
    "ablations, FID without each critic, of which it names neither category nor smoothing. They were "
    "measured on other shapes and with another extractor: no claim of equal conditions."
)

_SOLID_NOTE = (
    "Volume in cube volumes, thickness in cube sides (the median way straight through the solid); floating: "
    "share of tets outside the largest component. Means over generated shapes."
)


def tabulate_ablation(
    metrics: Sequence[Path], paper: Path, category: str, out: Path, changes: Mapping[str, str]
) -> None:
    """Write the table as CSV, and as Markdown beside it.

    Args:
        metrics: JSONs of `evaluate_model`, the full model's first; perhaps that of `evaluate_real` last.
        paper: published figures (`tetgan.tables.paper`).
        category: of the metrics.
        out: `.csv` to write.
        changes: how each model differs from the full one, in words.

    Raises:
        UserError: no model's metrics, or metrics of another category.
    """
    reports = read_reports(metrics, out, category)
    if all(is_real(report) for report in reports):
        raise UserError(f"{out}: no models to compare; name them in the config under 'ablation'")
    table = build_ablation(reports, read_paper(paper), category, changes)
    write_twins(table, _render(table, reports, category), out)


def build_ablation(
    reports: Sequence[Mapping[str, Any]], paper: pd.DataFrame, category: str, changes: Mapping[str, str]
) -> pd.DataFrame:
    """One row per model and smoothing, in the order in which models first come."""
    order = list(dict.fromkeys(report["model"] for report in reports))
    rows = []
    for smoothing, members in sorted(group_reports(reports), key=lambda row: order.index(row[1][0]["model"])):
        printed = printed_figures(paper, category, members, smoothing) if _in_paper(members[0], order) else {}
        row = identity_cells(members, smoothing)
        row["changes"] = changes.get(row["model"], "")
        for metric in COLUMNS:
            row |= metric_cells(metric, estimates_of(members, smoothing, metric), printed.get(metric))
        rows.append(row)
    identity = ["model", "changes", *(name for name in IDENTITY if name != "model")]
    metrics = [f"{metric}{part}" for metric in COLUMNS for part in METRIC_PARTS]
    return with_whole_counts(pd.DataFrame(rows, columns=[*identity, *metrics]))


def _in_paper(report: Mapping[str, Any], order: Sequence[str]) -> bool:
    """Whether the paper has figures of the model: of TetGANs, the full one and those without a critic."""
    return bool(report["model"] == order[0] or report.get("method") != "tetgan" or report.get("without"))


def _render(table: pd.DataFrame, reports: Sequence[Mapping[str, Any]], category: str) -> str:
    names = {"Model": table.apply(row_name, axis=1)}
    figures, solids = (
        markdown_table(names | metric_columns(table, headings_of(shown))) for shown in (_FIGURES, _SOLIDS)
    )
    made = markdown_table(names | {title: table[column].map(plain) for column, title in _MADE.items()})
    return page(
        f"Ablations on {category}",
        _ABOUT,
        figures,
        "## The solids",
        solids,
        "## How each row was made",
        made,
        notes=[_SOLID_NOTE, *table_notes(reports)],
    )
