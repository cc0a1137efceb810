"""Stage: share of manifold edges in ground truth and in generated meshes."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.evaluation.metrics import headings_of, names_of
from tetgan.tables.markdown import markdown_table, metric_columns, page, plain, row_name, write_twins
from tetgan.tables.paper import OWN_METHODS, quoted_figure, read_paper
from tetgan.tables.rows import (
    METRIC_PARTS,
    estimates_of,
    group_reports,
    identity_cells,
    is_real,
    known_mean,
    metric_cells,
    read_reports,
    with_whole_counts,
)

METRICS = ("manifold_edges", *names_of("edges"))
"""Shares of edges with two faces, one, and more; and the share of shapes that are closed manifolds."""

IDENTITY = (
    "category",
    "model",
    "grid",
    "tets",
    "mode",
    "smoothing",
    "simplified",
    "shapes",
    "seeds",
    "n",
    "reduced",
)

_NOTES = [
    "Shares of a mesh's edges with two faces (manifold), one, and three or more; means over meshes. A shape "
    "is manifold where every edge has two faces and the faces around each vertex form one fan.",
    "Ground truth: training shapes as the grid represents them, which is what a model learns from. "
    "Repaired: the watertight meshes before that.",
    "The paper's figures, in parentheses, are of its ground-truth chairs and of generated ones; it names "
    "neither grid nor smoothing.",
    "[…]: bootstrap intervals over meshes; ±: over seeds.",
]


def tabulate_manifold(metrics: Sequence[Path], paper: Path, out: Path) -> None:
    """Write the table as CSV, and as Markdown beside it.

    Args:
        metrics: JSONs of `evaluate_model` and `evaluate_real`, of any categories.
        paper: published figures (`tetgan.tables.paper`).
        out: `.csv` to write.

    Raises:
        UserError: no metrics.
    """
    table = build_manifold(read_reports(metrics, out), read_paper(paper))
    write_twins(table, _render(table), out)


def build_manifold(reports: Sequence[Mapping[str, Any]], paper: pd.DataFrame) -> pd.DataFrame:
    """One row per category, model, mode and smoothing: `IDENTITY`, then the columns of each metric."""
    rows = [
        _row(members, smoothing, paper)
        for category in dict.fromkeys(report["category"] for report in reports)
        for smoothing, members in group_reports([r for r in reports if r["category"] == category])
    ]
    columns = [*IDENTITY, *(f"{metric}{part}" for metric in METRICS for part in METRIC_PARTS)]
    return with_whole_counts(pd.DataFrame(rows, columns=columns))


def _row(members: Sequence[Mapping[str, Any]], smoothing: str, paper: pd.DataFrame) -> dict[str, Any]:
    first = members[0]
    shapes = _shapes(first, smoothing)
    estimates = {metric: estimates_of(members, smoothing, metric) for metric in METRICS}
    measured = known_mean(estimate.get("n") for estimate in estimates["manifold_edges"])
    row = identity_cells(members, smoothing) | {
        "category": first["category"],
        "shapes": shapes,
        "n": None if measured is None else round(measured),
    }
    own = first.get("method") in OWN_METHODS
    for metric, found in estimates.items():
        row |= metric_cells(
            metric, found, quoted_figure(paper, first["category"], shapes, metric) if own else None
        )
    return row


def _shapes(report: Mapping[str, Any], smoothing: str) -> str:
    """Which shapes of a model the edges belong to."""
    if is_real(report):
        return "repaired"
    if report.get("method") == "representation":
        return "ground truth"
    return "generated" if report["smoothings"][smoothing]["generated"]["found"] else "reconstructed"


def _render(table: pd.DataFrame) -> str:
    columns = {
        "Category": table["category"],
        "Model": table.apply(row_name, axis=1),
        "Shapes": table["shapes"],
        "N": table["n"].map(plain),
        **metric_columns(table, headings_of(METRICS)),
    }
    return page("Manifold edges", markdown_table(columns), notes=_NOTES)
