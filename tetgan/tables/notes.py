"""Markdown of a category's table, with the notes needed to read it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from tetgan.evaluation.jsd import CELLS
from tetgan.tables.markdown import cell, markdown_table, page, plain, round_value, row_name

_PAPERS = {"chamfer": "Chamfer ↓", "faces": "Faces", "fid": "FID ↓", "variety": "Variety ↑"}

_OURS = {
    "Reconstructions": {
        "chamfer_l1": "Chamfer L1 ↓",
        "fscore": "F-score ↑",
        "normal_consistency": "Normals ↑",
        "iou": "Field IoU ↑",
        "volume_iou": "Volume IoU ↑",
    },
    "Generated shapes beside hold-out shapes: features": {
        "kid": "KID ↓",
        "fid_infinity": "FID∞ ↓",
        "precision": "Precision ↑",
        "recall": "Recall ↑",
    },
    "Generated shapes beside hold-out shapes: distances": {
        "mmd": "MMD ↓",
        "cov": "COV ↑",
        "nna": "1-NNA → ½",
        "jsd": "JSD ↓",
        "novelty": "Novelty",
    },
    "Meshes": {
        "manifold_edges": "Manifold edges ↑",
        "inverted_tets": "Inverted tets ↓",
        "valid": "Valid solids ↑",
    },
}

TITLES = _PAPERS | {metric: title for group in _OURS.values() for metric, title in group.items()}
"""Heading of every metric; the arrow points to the better side."""

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


def render_table(table: pd.DataFrame, reports: Sequence[Mapping[str, Any]], category: str) -> str:
    """Markdown of a table made by `build_table` from those reports."""
    names = {"Model": table.apply(row_name, axis=1)}
    return page(
        category,
        _ABOUT_PAPER,
        markdown_table(names | {title: table.apply(cell, axis=1, metric=m) for m, title in _PAPERS.items()}),
        "## Beyond the paper",
        *_groups(table, names),
        "## How each row was made",
        markdown_table(names | {title: table[column].map(plain) for column, title in _MADE.items()}),
        notes=table_notes(table, reports),
    )


def _groups(table: pd.DataFrame, names: Mapping[str, pd.Series]) -> Iterator[str]:
    """Heading and table of every group of our metrics."""
    for heading, titles in _OURS.items():
        yield f"### {heading}"
        yield markdown_table(
            {**names, **{title: table.apply(cell, axis=1, metric=m) for m, title in titles.items()}}
        )


def table_notes(table: pd.DataFrame, reports: Sequence[Mapping[str, Any]]) -> list[str]:
    """Conventions, extractor, floor, and warnings of single rows."""
    return [
        *_conventions(reports[0]["options"]),
        *extractor_notes(reports),
        *_floor(table),
        *_warnings(reports),
    ]


def _conventions(options: Mapping[str, Any]) -> list[str]:
    variety = options["variety"]
    return [
        f"[…]: {100 * options['bootstrap']['level']:g} % intervals; ±: over seeds, or for one seed over "
        "repeats (variety) and blocks (KID). docs/metrics.md defines every metric.",
        f"Chamfer: mean squared nearest distance each way, summed, {options['points']:,} points a surface, "
        f"unit cube, against the repaired mesh. F-score at {options['fscore_threshold']:g} of the cube.",
        f"Variety: mean Chamfer of the {variety['closest']} closest of {variety['pairs']} {drawn(variety)}, "
        f"{variety['repeats']} repeats.",
        f"FID, KID, FID∞, precision and recall: {options['samples']} surfaces on each side, against hold-out "
        "surfaces.",
        *set_conventions(options),
    ]


def drawn(variety: Mapping[str, Any]) -> str:
    """The things that variety draws, in words."""
    return "random pairs" if variety["definition"] == "text" else "random shapes, all pairs"


def set_conventions(options: Mapping[str, Any]) -> list[str]:
    """Conventions of the comparison of sets, from the options of a report."""
    sets = options["sets"]
    return [
        f"MMD, COV and 1-NNA: {sets['shapes']} shapes on each side, Chamfer distance of {sets['points']} "
        f"points a shape. JSD: points of the same shapes in {CELLS}³ cells, in bits. Novelty: mean Chamfer "
        "distance to the nearest training shape, points as many; neither high nor low is good in itself.",
        f"Volume IoU: {options['volume_points']:,} points in the box of both shapes, winding number above ½.",
    ]


def extractor_line(extractor: Mapping[str, Any]) -> str:
    """Line about the classifier behind the features, from a report."""
    return (
        f"Extractor {extractor['digest']}: PointNet++ on {', '.join(extractor['categories'])}; held-out "
        f"accuracy {100 * extractor['accuracy']:.1f} %. Absolute FID and KID depend on it."
    )


def extractor_notes(reports: Sequence[Mapping[str, Any]]) -> list[str]:
    """Name the classifier behind FID and KID, with a warning where rows have several."""
    found = {report["extractor"]["digest"]: report["extractor"] for report in reports}
    lines = [extractor_line(extractor) for extractor in found.values()]
    if len(found) > 1:
        lines.append(
            "**Rows were measured with different extractors: their FID and KID cannot be compared.**"
        )
    return lines


def _floor(table: pd.DataFrame) -> list[str]:
    real = table[table["model"] == "real"]
    if real.empty:
        return []
    figures = ", ".join(
        f"{title} {round_value(value)}"
        for metric, title in (("fid", "FID"), ("kid", "KID"), ("chamfer", "Chamfer"), ("mmd", "MMD"))
        if not pd.isna(value := real.iloc[0][metric])
    )
    return [
        f"Floor (row `real`): {figures or 'not measured'}. Features and sets compare real training surfaces "
        "with real hold-out surfaces; Chamfer compares a mesh with itself, sampled twice; novelty is that of "
        "hold-out surfaces. A model below it cannot be distinguished from a perfect one."
    ]


def _warnings(reports: Sequence[Mapping[str, Any]]) -> list[str]:
    """Each distinct note once, with the rows it holds for."""
    rows: dict[str, list[str]] = {}
    for report in reports:
        for smoothing, section in report["smoothings"].items():
            made = f"{'solid, ' * (report.get('mode') == 'solid')}{smoothing}"
            name = report["model"] if report["model"] == "real" else f"{report['model']} ({made})"
            missing = section["generated"]["expected"] - section["generated"]["found"]
            lost = [f"Generated shapes without a surface, left out: {missing}"] if missing else []
            for note in [*section["notes"], *lost]:
                rows.setdefault(note, []).append(name)
    total = sum(len(report["smoothings"]) for report in reports)
    return [
        f"{note}. ({'all rows' if len(names) == total else ', '.join(dict.fromkeys(names))})"
        for note, names in rows.items()
    ]
