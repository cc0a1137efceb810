"""Rows of tables from the JSONs of the evaluation: one for each model, mode and smoothing, over its seeds."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tetgan.errors import UserError
from tetgan.tables.paper import published

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

METRIC_PARTS = ("", "_std", "_low", "_high", "_n", "_paper")
"""Endings of the columns of a metric."""

_SMOOTHING_ORDER = {"none": 0, "wls": 1}

REAL = "real"
"""Method of the row that measures real shapes against real shapes."""

_METHODS = ("tetgan", None, "representation", "pca", REAL)  # order of rows; None: every other method


def read_reports(paths: Sequence[Path], out: Path, category: str | None = None) -> list[dict[str, Any]]:
    """Metrics as the evaluation wrote them.

    Raises:
        UserError: none to make the table `out` of, or a file that holds something else, or another category.
    """
    if not paths:
        raise UserError(f"{out}: no metrics to make a table of")
    reports = []
    for path in paths:
        try:
            report = json.loads(path.read_text())
            if not {"category", "model", "smoothings"} <= report.keys():
                raise ValueError("a key is missing")
        except (ValueError, AttributeError) as error:
            raise UserError(
                f"{path}: not metrics of `tetgan evaluate-model` or `tetgan evaluate-real` ({error})"
            ) from None
        if category not in (None, report["category"]):
            raise UserError(f"{path}: metrics of '{report['category']}', not of '{category}'")
        reports.append(report)
    return reports


def group_reports(reports: Sequence[Mapping[str, Any]]) -> list[tuple[str, list[Mapping[str, Any]]]]:
    """The smoothing and the reports behind each row, in the order of a table's rows."""
    groups: dict[tuple[str, str, str], list[Mapping[str, Any]]] = {}
    for report in reports:
        for smoothing in report["smoothings"]:
            groups.setdefault((report["model"], report.get("mode", ""), smoothing), []).append(report)
    return [(smoothing, members) for (_, _, smoothing), members in sorted(groups.items(), key=_place)]


def is_real(report: Mapping[str, Any]) -> bool:
    """Whether real shapes were measured, rather than a model."""
    return bool(report.get("method") == REAL)


def _place(group: tuple[tuple[str, str, str], Sequence[Mapping[str, Any]]]) -> tuple[Any, ...]:
    """Sort key: method, then size of the grid, then name with numbers as numbers, mode, smoothing."""
    (model, mode, smoothing), members = group
    method = members[0].get("method")
    rank = _METHODS.index(method if method in _METHODS else None)
    natural = [(part.isdigit(), part.zfill(9)) for part in re.findall(r"\d+|\D+", model)]
    return rank, members[0].get("tets") or 0, natural, mode, _SMOOTHING_ORDER.get(smoothing, 2)


def printed_figures(
    paper: pd.DataFrame, category: str, members: Sequence[Mapping[str, Any]], smoothing: str
) -> dict[str, str]:
    """Metric to the paper's figure, for the row of these reports."""
    return published(paper, category, members[0], smoothing)


def identity_cells(members: Sequence[Mapping[str, Any]], smoothing: str) -> dict[str, Any]:
    """The columns of `IDENTITY` for the row of these reports."""
    first = members[0]
    sections = [member["smoothings"][smoothing] for member in members]
    real = is_real(first)
    row = {name: first.get(name) for name in ("model", "grid", "tets", "mode", "reduced")}
    if not row["tets"]:
        row["mode"] = None  # a surface without tets is not meshed in any
    return row | {
        "smoothing": smoothing if len(first["smoothings"]) > 1 else None,  # no choice, nothing to tell
        "simplified": None if real else bool(first.get("simplified", False)),
        "seeds": None if real else len(members),
        "n": round(float(np.mean([section["generated"]["found"] for section in sections]))),
        "train_minutes": known_mean(member.get("train_minutes") for member in members),
        "extractor": " ".join(sorted({member["extractor"]["digest"] for member in members})),
    }


def estimates_of(
    members: Sequence[Mapping[str, Any]], smoothing: str, metric: str
) -> list[Mapping[str, Any]]:
    """The metric as each report has it; empty where one lacks it."""
    return [member["smoothings"][smoothing]["metrics"].get(metric, {}) for member in members]


def metric_cells(
    column: str, estimates: Sequence[Mapping[str, Any]], printed: str | None = None
) -> dict[str, Any]:
    """Value, interval and number of items, averaged over seeds; deviation over seeds, or within the only one.

    The items are what the value rests on: meshes, or for what compares two sets the surfaces on each side.

    Args:
        column: name of the value's column, to which the others append.
        printed: the paper's figure.
    """
    measured = [estimate for estimate in estimates if estimate.get("value") is not None]
    values = [estimate["value"] for estimate in measured]
    within = estimates[0].get("std") if len(estimates) == 1 else None
    return {
        column: known_mean(values),
        f"{column}_std": float(np.std(values, ddof=1)) if len(values) > 1 else within,
        f"{column}_low": known_mean(estimate.get("low") for estimate in estimates),
        f"{column}_high": known_mean(estimate.get("high") for estimate in estimates),
        f"{column}_n": rounded_mean(estimate.get("n") for estimate in measured),
        f"{column}_paper": printed,
    }


def rounded_mean(values: Iterable[float | int | None]) -> int | None:
    """Mean of the counts that are there, as a whole number."""
    mean = known_mean(values)
    return None if mean is None else round(mean)


def known_mean(values: Iterable[float | int | None]) -> float | None:
    """Mean of the values that are there."""
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def with_whole_counts(table: pd.DataFrame) -> pd.DataFrame:
    """Counts as whole numbers that may be missing, rather than as floats."""
    counts = [
        name for name in map(str, table) if name in ("tets", "seeds", "n") or name.endswith(("_n", "_seeds"))
    ]
    return table.astype(dict.fromkeys(counts, "Int64"))
