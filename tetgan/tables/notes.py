"""Notes below tables: conventions, extractor, floor, and what to know of some rows."""

from collections.abc import Mapping, Sequence
from typing import Any

from tetgan.evaluation.jsd import CELLS
from tetgan.evaluation.metrics import BY_NAME, names_of, titles_of
from tetgan.tables.markdown import round_value
from tetgan.tables.rows import is_real


def table_notes(reports: Sequence[Mapping[str, Any]]) -> list[str]:
    """Conventions, extractor, floor, and remarks on some rows."""
    return [
        *_conventions(reports[0]["options"]),
        *extractor_notes(reports),
        *_floor(reports),
        *remarks(reports),
    ]


def _conventions(options: Mapping[str, Any]) -> list[str]:
    variety = options["variety"]
    return [
        f"[…]: {100 * options['bootstrap']['level']:g} % intervals; ±: over seeds, or for one seed over "
        "repeats (variety) and blocks (KID). docs/metrics.md defines every metric.",
        f"Chamfer: mean squared nearest distance each way, summed, {options['points']:,} points a surface, "
        "unit cube, against the repaired mesh; mean over the reconstructions that have a surface. F-score at "
        f"{options['fscore_threshold']:g} of the cube; it and volume IoU count a missing surface as 0.",
        f"Variety: mean Chamfer of the {variety['closest']} closest of {variety['pairs']} {drawn(variety)}, "
        f"{variety['repeats']} repeats.",
        f"{titles_of(names_of('features'))}: {options['samples']} surfaces on each side, against hold-out "
        "surfaces.",
        *set_conventions(options),
    ]


def drawn(variety: Mapping[str, Any]) -> str:
    """Of what variety draws so many, in words."""
    return "random pairs" if variety["definition"] == "text" else "random shapes, all pairs"


def set_conventions(options: Mapping[str, Any]) -> list[str]:
    """Conventions of the comparison of sets, from the options of a report."""
    sets = options["sets"]
    of_distances = [name for name in names_of("sets") if name != "jsd"]
    return [
        f"{titles_of(of_distances)}: {sets['shapes']} shapes on each side, Chamfer distance of "
        f"{sets['points']} points a shape. JSD: points of the same shapes in {CELLS}³ cells, in bits. "
        "Novelty: mean Chamfer distance to the nearest training shape, points as many; neither high nor low "
        "is good in itself.",
        f"Volume IoU: {options['volume_points']:,} points in the box of both shapes, winding number above ½.",
    ]


def extractor_line(extractor: Mapping[str, Any]) -> str:
    """What is known of the classifier behind the features, from a report."""
    return (
        f"Extractor {extractor['digest']}: PointNet++ on {', '.join(extractor['categories'])}; held-out "
        f"accuracy {100 * extractor['accuracy']:.1f} %. Absolute FID and KID depend on it."
    )


def extractor_notes(reports: Sequence[Mapping[str, Any]]) -> list[str]:
    """Which classifier FID and KID rest on, and a warning where rows rest on several."""
    found = {report["extractor"]["digest"]: report["extractor"] for report in reports}
    lines = [extractor_line(extractor) for extractor in found.values()]
    if len(found) > 1:
        lines.append(
            "**Rows were measured with different extractors: their FID and KID cannot be compared.**"
        )
    return lines


def _floor(reports: Sequence[Mapping[str, Any]]) -> list[str]:
    real = next((report for report in reports if is_real(report)), None)
    if real is None:
        return []
    [section] = real["smoothings"].values()
    figures = ", ".join(
        f"{BY_NAME[metric].title} {round_value(value)}"
        for metric in ("fid", "kid", "chamfer", "mmd")
        if (value := section["metrics"].get(metric, {}).get("value")) is not None
    )
    return [
        f"Floor (row `real`): {figures or 'not measured'}. Features and sets compare real training surfaces "
        "with real hold-out surfaces; Chamfer compares a mesh with itself, sampled twice; novelty is that of "
        "hold-out surfaces. Below it no model can be distinguished from a perfect one."
    ]


def remarks(reports: Sequence[Mapping[str, Any]]) -> list[str]:
    """Each distinct note once, with the rows it holds for."""
    rows: dict[str, list[str]] = {}
    for report in reports:
        for smoothing, section in report["smoothings"].items():
            made = f"{'solid, ' * (report.get('mode') == 'solid')}{smoothing}"
            name = report["model"] if is_real(report) else f"{report['model']} ({made})"
            for note in section["notes"]:
                rows.setdefault(note, []).append(name)
    total = sum(len(report["smoothings"]) for report in reports)
    return [
        f"{note}. ({'all rows' if len(names) == total else ', '.join(dict.fromkeys(names))})"
        for note, names in rows.items()
    ]
