"""Stage: the metrics of a category in one table, the paper's figures beside ours."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tetgan.errors import UserError
from tetgan.evaluation.paper import published, read_paper
from tetgan.evaluation.readable import render_table
from tetgan.files import whole_file

METRICS = (
    "chamfer",
    "faces",
    "fid",
    "variety",
    "kid",
    "manifold_edges",
    "inverted_tets",
    "iou",
    "chamfer_l1",
    "fscore",
    "normal_consistency",
)
"""In the order of the columns: the paper's Table 1 first."""

IDENTITY = (
    "model",
    "grid",
    "tets",
    "mode",
    "smoothing",
    "simplified",
    "seeds",
    "n",
    "train_minutes",
    "reduced",
    "extractor",
)
"""First columns of a table."""

_SMOOTHING_ORDER = {"none": 0, "wls": 1}
_ROW_ORDER = ("tetgan", "", "representation", "pca", "real")  # "": every other model


def write_table(metrics: Sequence[Path], paper: Path, category: str, out: Path) -> None:
    """Write the table as CSV, and as Markdown beside it.

    One row a model, mode and smoothing; several seeds of a model become one row. Missing is empty, never 0.

    Args:
        metrics: JSONs of `evaluate_model` and `evaluate_real`.
        paper: published figures (`tetgan.evaluation.paper`).
        category: theirs; metrics of another one are an error.
        out: `.csv` to write.

    Raises:
        UserError: no metrics, or metrics of another category.
    """
    reports = [_read_report(path, category) for path in metrics]
    if not reports:
        raise UserError(f"{out}: no metrics to make a table of")
    table = build_table(reports, read_paper(paper), category)
    with whole_file(out) as partial:
        table.to_csv(partial, index=False)
    with whole_file(out.with_suffix(".md")) as partial:
        partial.write_text(render_table(table, reports, category))


def build_table(reports: Sequence[Mapping[str, Any]], paper: pd.DataFrame, category: str) -> pd.DataFrame:
    """Rows in the order of the paper, then the bounds: representation, PCA, real shapes."""
    groups: dict[tuple[str, str, str], list[Mapping[str, Any]]] = {}
    for report in reports:
        for smoothing in report["smoothings"]:
            groups.setdefault((report["model"], report.get("mode", ""), smoothing), []).append(report)
    rows = [
        _row(members, smoothing, published(paper, category, model, members[0].get("grid", ""), smoothing))
        for (model, _, smoothing), members in sorted(groups.items(), key=_place)
    ]
    columns = [
        *IDENTITY,
        *(f"{m}{part}" for m in METRICS for part in ("", "_std", "_low", "_high", "_paper")),
    ]
    table = pd.DataFrame(rows, columns=columns)
    return table.astype(dict.fromkeys(("tets", "seeds", "n"), "Int64"))


def _read_report(path: Path, category: str) -> dict[str, Any]:
    report = json.loads(path.read_text())
    if report.get("category", category) != category:
        raise UserError(f"{path}: metrics of '{report['category']}', not of '{category}'")
    return report


def _place(group: tuple[tuple[str, str, str], Sequence[Mapping[str, Any]]]) -> tuple[Any, ...]:
    """Sort key: kind of row, then size of the grid, then name with numbers as numbers, mode, smoothing."""
    (model, mode, smoothing), members = group
    kind = next((place for place, name in enumerate(_ROW_ORDER) if name and model.startswith(name)), 1)
    natural = [(part.isdigit(), part.zfill(9)) for part in re.findall(r"\d+|\D+", model)]
    return kind, members[0].get("tets") or 0, natural, mode, _SMOOTHING_ORDER.get(smoothing, 2)


def _row(members: Sequence[Mapping[str, Any]], smoothing: str, paper: Mapping[str, str]) -> dict[str, Any]:
    first = members[0]
    sections = [member["smoothings"][smoothing] for member in members]
    real = first["model"] == "real"
    row = {name: first.get(name) for name in ("model", "grid", "tets", "mode", "reduced")}
    row |= {
        "smoothing": smoothing if len(first["smoothings"]) > 1 else None,  # no choice, nothing to tell
        "simplified": None if real else bool(first.get("simplified", False)),
        "seeds": None if real else len(members),
        "n": round(float(np.mean([section["generated"]["found"] for section in sections]))),
        "train_minutes": _mean(member.get("train_minutes") for member in members),
        "extractor": " ".join(sorted({member["extractor"]["digest"] for member in members})),
    }
    for metric in METRICS:
        row |= _cells(metric, [section["metrics"].get(metric, {}) for section in sections], paper.get(metric))
    return row


def _cells(metric: str, estimates: Sequence[Mapping[str, Any]], printed: str | None) -> dict[str, Any]:
    """Value and interval, averaged over seeds; deviation over seeds, or within the one seed there is."""
    values = [estimate["value"] for estimate in estimates if estimate.get("value") is not None]
    within = estimates[0].get("std") if len(estimates) == 1 else None
    return {
        metric: _mean(values),
        f"{metric}_std": float(np.std(values, ddof=1)) if len(values) > 1 else within,
        f"{metric}_low": _mean(estimate.get("low") for estimate in estimates),
        f"{metric}_high": _mean(estimate.get("high") for estimate in estimates),
        f"{metric}_paper": printed,
    }


def _mean(values: Iterable[float | int | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None
