"""Report on two folders of meshes: figures, their meaning, and warnings."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.errors import UserError
from tetgan.evaluation.folders import measure_folders
from tetgan.evaluation.metrics import METRICS, names_of, titles_of
from tetgan.files import whole_file
from tetgan.tables.markdown import round_value
from tetgan.tables.notes import drawn, extractor_line, set_conventions

_FEW = 100

_MOST_PROBLEMS = 50


def evaluate_folders(samples: Path, reference: Path, *, out: Path, **settings: Any) -> None:
    """Measure two folders, and write the figures as JSON with a report for people beside it.

    Args:
        out: the JSON to write.
        settings: further arguments of `measure_folders`.

    Raises:
        UserError: as `measure_folders`; or `out` is no `.json`.
    """
    if out.suffix != ".json":
        raise UserError(f"{out}: name a .json; the report for people is written beside it, as .md")
    report = measure_folders(samples, reference, **settings)
    with whole_file(out) as partial:
        partial.write_text(json.dumps(report, indent=1) + "\n")
    with whole_file(out.with_suffix(".md")) as partial:
        partial.write_text(render_report(report))


def render_report(report: Mapping[str, Any]) -> str:
    """Markdown of what `measure_folders` found."""
    parts = [
        f"# {report['samples']} beside {report['reference']}",
        _figures(report),
        "## Conventions",
        _bullets(_conventions(report)),
        "## Read with care",
        _bullets(_warnings(report)),
    ]
    if report["problems"]:
        parts += ["## Meshes left out", _bullets(_problems(report["problems"]))]
    return "\n\n".join(parts) + "\n"


def _figures(report: Mapping[str, Any]) -> str:
    """A row for every metric that either side has."""
    found, floor = report["found"]["metrics"], (report["floor"] or {"metrics": {}})["metrics"]
    rows = [
        {
            "Metric": metric.heading,
            "Samples": _cell(found.get(metric.name)),
            "N": _number(found.get(metric.name)),
            "Floor": _cell(floor.get(metric.name)),
            "N of the floor": _number(floor.get(metric.name)),
            "What it is": metric.meaning,
        }
        for metric in METRICS
        if any(side.get(metric.name, {}).get("value") is not None for side in (found, floor))
    ]
    return pd.DataFrame(rows).to_markdown(index=False, disable_numparse=True)


def _cell(estimate: Mapping[str, Any] | None) -> str:
    """Value ± deviation [interval]."""
    if estimate is None or estimate["value"] is None:
        return "—"
    deviation = "" if estimate["std"] is None else f" ± {round_value(estimate['std'])}"
    ends = [estimate["low"], estimate["high"]]
    interval = "" if None in ends else f" [{', '.join(map(round_value, ends))}]"
    return f"{round_value(estimate['value'])}{deviation}{interval}"


def _number(estimate: Mapping[str, Any] | None) -> str:
    return str(estimate["n"]) if estimate and estimate["value"] is not None else ""


def _conventions(report: Mapping[str, Any]) -> Iterator[str]:
    options = report["options"]
    variety, level = options["variety"], 100 * options["bootstrap"]["level"]
    if report["fitted"]:
        yield "Every mesh is moved and scaled: its bounding box centred in the unit cube, the longest side 1."
    else:
        yield "Nothing is moved or scaled: meshes are measured as they are stored; lengths in their unit."
    yield (
        "Points are drawn uniformly by area from all triangles, hidden ones too. Vertices at one position "
        "are one, triangles without an area are left out."
    )
    yield "Where shapes are chosen, they are drawn at random without replacement, as many on each side."
    yield (
        "Floor: the reference cut at random into two halves, one beside the other (faces, manifold edges and "
        "variety: of the whole reference; reconstructions: each original beside itself, sampled twice). What "
        "a perfect generator would score at that N."
    )
    yield f"[…]: {level:g} % intervals; ±: over the draws of variety, over random blocks of features for KID."
    yield (
        f"Chamfer: {options['points']:,} points a surface. F-score at {options['fscore_threshold']:g}. "
        f"Variety: the {variety['closest']} closest of {variety['pairs']} {drawn(variety)}, "
        f"{variety['repeats']} repeats."
    )
    yield from set_conventions(options)
    if report["extractor"]:
        yield extractor_line(report["extractor"])
        yield (
            f"Features: 1,024 farthest of {report['cloud_points']:,} points, centred, in the unit sphere: "
            "size and place play no part."
        )
    yield f"tetgan {report['version']}, seed {options['seed']}; docs/metrics.md defines every metric."


def _warnings(report: Mapping[str, Any]) -> Iterator[str]:
    for name in ("samples", "reference", "reconstructions", "training"):
        count = report["meshes"].get(name)
        if count and count["unusable"]:
            yield f"{count['unusable']} of {count['files']} meshes of the {name} are left out, listed below."
    yield from _left_out(report)
    yield from _small_numbers(report)
    yield from (f"{note}." for note in report["found"]["notes"])
    floor = report["floor"]
    yield from (f"Floor: {note}." for note in (floor["notes"] if floor else []))


def _left_out(report: Mapping[str, Any]) -> Iterator[str]:
    """Metrics for which something was not given."""
    if not report["extractor"]:
        yield f"No --extractor, so no {titles_of(names_of('features'))}."
    if not report["reconstructions"]:
        given = [name for name in names_of("reconstruction") if name != "iou"]
        yield f"No --reconstructions, so no {titles_of(given)}."
    if not report["training"]:
        yield "No --training, so no novelty: copies of training shapes would go unnoticed."


def _small_numbers(report: Mapping[str, Any]) -> Iterator[str]:
    shapes = report["options"]["sets"]["shapes"]
    if shapes < _FEW:
        yield (
            f"**Only {shapes} shapes on each side**: COV moves in steps of {1 / shapes:.2g}, 1-NNA in steps "
            f"of {1 / (2 * shapes):.2g}. Read the intervals, not the figures."
        )
    if not report["floor"]:
        yield "The reference is too small to be cut into halves: there is no floor."
    elif _most_compared(report["floor"]) < _most_compared(report["found"]):
        yield (
            "Half of the reference is fewer shapes than were compared, and FID, MMD, JSD, COV, precision and "
            "recall depend on how many there are: with as many as the samples, the floor of FID, MMD and JSD "
            "would be lower."
        )


def _most_compared(section: Mapping[str, Any]) -> int:
    return max(section["metrics"].get(name, {"n": 0})["n"] for name in names_of("features", "sets"))


def _problems(problems: Mapping[str, str]) -> Iterator[str]:
    for path, why in list(problems.items())[:_MOST_PROBLEMS]:
        yield f"`{path}`: {why}"
    if len(problems) > _MOST_PROBLEMS:
        yield f"and {len(problems) - _MOST_PROBLEMS} more, in the JSON"


def _bullets(lines: Iterator[str]) -> str:
    return "\n".join(f"- {line}" for line in lines) or "- Nothing."
