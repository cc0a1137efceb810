"""Stage: time and memory of every stage, from the benchmark files that Snakemake writes."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from tetgan.errors import UserError
from tetgan.shapes.catalogue import read_catalogue
from tetgan.shapes.clouds import read_clouds
from tetgan.tables.dataset import count_shapes
from tetgan.tables.markdown import markdown_table, page, plain, round_value, write_twins
from tetgan.tables.paper import quoted_figure, read_paper
from tetgan.tables.rows import group_reports, is_real, known_mean, read_reports

BENCHMARKS = (
    "repair_shapes/{category}/{shard}",
    "sample_clouds/{category}",
    "extract_fields/{category}/{grid}/{shard}",
    "extract_samplings/{category}/{sampling}/{shard}",
    "train_extractor",
    "train_model/{category}/{model}/{seed}",
    "sample_model/{category}/{model}/{seed}/{mode}",
    "simplify_samples/{category}/{model}/{seed}/{mode}",
    "evaluate_model/{category}/{model}/{seed}/{mode}",
    "evaluate_real/{category}",
)
"""Where each rule has its benchmark files, below their folder and without `.tsv`; a new stage adds a line."""

STUDIES = (
    "interpolate_shapes/{category}/{model}/{seed}",
    "add_parts/{category}/{model}/{seed}",
    "find_nearest/{category}/{model}/{seed}/{mode}",
    "find_nearest_real/{category}",
    "measure_smoothing/{category}/{model}/{seed}",
    "simulate_samples/{category}/{model}/{seed}/{mode}",
    "measure_resolution",
)
"""The same of figures and studies, which some models have: rows where something was measured."""

COLUMNS = (
    "stage",
    "category",
    "grid",
    "sampling",
    "model",
    "mode",
    "jobs",
    "jobs_measured",
    "shapes",
    "seconds",
    "seconds_std",
    "seconds_a_shape",
    "cpu_seconds",
    "max_rss_mib",
    "train_minutes",
    "paper",
)

_KEYS = ("category", "grid", "sampling", "model", "mode")

_OF_TRAINED, _OF_SIMPLIFIED = ("train_model", "sample_model"), "simplify_samples"

_TRAINING = {"train_model", "train_extractor"}  # whose time is not one of shapes

_COUNTS = ("jobs", "jobs_measured", "shapes")

_NOTES = [
    "Seconds are those of a stage's jobs one after another, all shards together, as Snakemake measured them: "
    "wall time, in which other jobs may have had the cores; CPU seconds beside them. ± over seeds.",
    "Training time is from the training log, which counts what came before a resumption too; a benchmark "
    "sees only the last run of a job.",
    "preprocess is repair_shapes and extract_fields together. A sampled or evaluated shape is a generated or "
    "a reconstructed one, each with and without smoothing.",
    "Memory is the resident set at its largest in any job of the row; memory of a GPU is not in it.",
    "Figures and studies have rows where they had run before this table was made.",
    "—: no benchmark file, because the stage ran before it had one or elsewhere.",
    "The paper's figures are as printed: its shapes, sizes and machines.",
]


class Job(NamedTuple):
    """Facts in a metrics file about the jobs behind it; None where a stage has no such thing."""

    category: str
    grid: str | None = None
    sampling: str | None = None
    model: str | None = None
    method: str | None = None
    mode: str | None = None
    seed: int | None = None
    simplified: bool = False
    shapes: int | None = None
    train_minutes: float | None = None


class Cost(NamedTuple):
    """Time of the jobs of one seed, None unless all of them were measured; and how many were."""

    seconds: float | None
    cpu_seconds: float | None
    max_rss_mib: float | None
    jobs: int
    measured: int


def tabulate_runtime(metrics: Sequence[Path], results: Path, paper: Path, shards: int, out: Path) -> None:
    """Write the table as CSV, and as Markdown beside it.

    Args:
        metrics: JSONs of `evaluate_model` and `evaluate_real`: their models and categories are the rows.
        results: folder that has `benchmarks/`, `data/{category}/catalogue.csv` and `clouds/{category}.npz`;
            what it lacks is an empty cell.
        paper: published figures (`tetgan.tables.paper`).
        shards: parts into which each category's shapes are cut.
        out: `.csv` to write.

    Raises:
        UserError: no metrics, or a file that is not what it should be.
    """
    in_order = group_reports(read_reports(metrics, out))
    jobs = [_job(report) for _, members in in_order for report in members]
    categories = dict.fromkeys(job.category for job in jobs)
    shapes = {category: _count_shapes(results, category) for category in categories}
    table = build_runtime(jobs, shapes, results / "benchmarks", shards, read_paper(paper))
    write_twins(table, _render(table), out)


def build_runtime(
    jobs: Sequence[Job],
    shapes: Mapping[str, Mapping[str, int]],
    benchmarks: Path,
    shards: int,
    paper: pd.DataFrame,
) -> pd.DataFrame:
    """Rows stage by stage, in the order of the workflow, then the paper's preprocessing.

    Args:
        shapes: for each category, stage to the number of shapes it handles.
    """
    rows = [
        _row(place, members, shapes, benchmarks, shards)
        for place in BENCHMARKS
        for members in _groups(place, jobs)
    ]
    studies = [
        _row(place, members, {}, benchmarks, shards) for place in STUDIES for members in _groups(place, jobs)
    ]
    rows += [row | {"shapes": None, "seconds_a_shape": None} for row in studies if row["jobs_measured"]]
    for row in rows:
        row["paper"] = _printed(row, paper)
    rows += _preprocessing(rows, paper)
    table = pd.DataFrame(rows, columns=list(COLUMNS)).astype(dict.fromkeys(_COUNTS, "Int64"))
    return table.round(dict.fromkeys(("seconds", "seconds_std", "cpu_seconds"), 2) | {"seconds_a_shape": 4})


def _job(report: Mapping[str, Any]) -> Job:
    if is_real(report):
        return Job(report["category"])
    section = next(iter(report["smoothings"].values()))
    return Job(
        category=report["category"],
        grid=report.get("grid") or None,
        sampling=report.get("sampling"),
        model=report["model"],
        method=report.get("method"),
        mode=report.get("mode"),
        seed=report.get("seed"),
        simplified=bool(report.get("simplified", False)),
        shapes=sum(section.get(kind, {}).get("expected", 0) for kind in ("generated", "reconstructed")),
        train_minutes=report.get("train_minutes"),
    )


def _count_shapes(results: Path, category: str) -> dict[str, int]:
    """Stage to the number of a category's shapes that it handles; stages without one are missing."""
    counts: dict[str, int] = {}
    catalogue, clouds = results / "data" / category / "catalogue.csv", results / "clouds" / f"{category}.npz"
    if catalogue.is_file():
        found = count_shapes(read_catalogue(catalogue))
        repaired = found["ok"] + found["filled"]
        counts = dict.fromkeys(("extract_fields", "extract_samplings", "evaluate_real"), repaired)
        counts |= {"repair_shapes": found["listed"], "train_model": found["train"]}
    if clouds.is_file():
        sampled = read_clouds(clouds)
        counts["sample_clouds"] = len(sampled.train_ids) + len(sampled.holdout_ids)
    return counts


def _groups(place: str, jobs: Sequence[Job]) -> list[list[Job]]:
    """The jobs of each row of a stage, one a seed."""
    if place.startswith(_OF_TRAINED):
        jobs = [job for job in jobs if not job.simplified]
    elif place.startswith(_OF_SIMPLIFIED):
        jobs = [job for job in jobs if job.simplified]
    names = [name for name in (*_KEYS, "seed") if f"{{{name}}}" in place]
    groups: dict[tuple[Any, ...], dict[Any, Job]] = {}
    for job in jobs:
        values = {name: getattr(job, name) for name in names}
        if None not in values.values():
            key = tuple(value for name, value in values.items() if name != "seed")
            groups.setdefault(key, {}).setdefault(values.get("seed"), job)
    return [list(members.values()) for members in groups.values()]


def _row(
    place: str, members: Sequence[Job], shapes: Mapping[str, Mapping[str, int]], benchmarks: Path, shards: int
) -> dict[str, Any]:
    first, stage = members[0], place.split("/", 1)[0]
    costs = [_measure(place, job, benchmarks, shards) for job in members]
    seconds = [cost.seconds for cost in costs if cost.seconds is not None]
    total, handled = known_mean(seconds), _handled(place, members, shapes)
    return {
        "stage": stage,
        **{name: getattr(first, name) for name in _KEYS if f"{{{name}}}" in place},
        "method": first.method,
        "jobs": sum(cost.jobs for cost in costs),
        "jobs_measured": sum(cost.measured for cost in costs),
        "shapes": handled,
        "seconds": total,
        "seconds_std": float(np.std(seconds, ddof=1)) if len(seconds) > 1 else None,
        "seconds_a_shape": None if stage in _TRAINING or not (total and handled) else total / handled,
        "cpu_seconds": known_mean(cost.cpu_seconds for cost in costs),
        "max_rss_mib": max((c.max_rss_mib for c in costs if c.max_rss_mib is not None), default=None),
        "train_minutes": known_mean(j.train_minutes for j in members) if stage == "train_model" else None,
    }


def _handled(place: str, members: Sequence[Job], shapes: Mapping[str, Mapping[str, int]]) -> int | None:
    """Shapes that one seed of a stage goes through, where that is known."""
    if "{category}" not in place:
        return None
    if "{mode}" not in place:
        return shapes.get(members[0].category, {}).get(place.split("/", 1)[0])
    sampled = known_mean(job.shapes for job in members)
    return None if sampled is None else round(sampled)


def _measure(place: str, job: Job, benchmarks: Path, shards: int) -> Cost:
    paths = list(_benchmark_paths(place, job, benchmarks, shards))
    found = [_read_benchmark(path) for path in paths if path.is_file()]
    memory = [each["max_rss"] for each in found if not np.isnan(each["max_rss"])]
    return Cost(
        seconds=_total([each["s"] for each in found], len(paths)),
        cpu_seconds=_total([each["cpu_time"] for each in found], len(paths)),
        max_rss_mib=max(memory, default=None),
        jobs=len(paths),
        measured=len(found),
    )


def _benchmark_paths(place: str, job: Job, benchmarks: Path, shards: int) -> Iterator[Path]:
    parts = [f"{part}-of-{shards}" for part in range(1, shards + 1)] if "{shard}" in place else [""]
    for part in parts:
        yield benchmarks / f"{place.format(**job._asdict(), shard=part)}.tsv"


def _read_benchmark(path: Path) -> pd.Series:
    """Wall seconds, CPU seconds and MiB, means over repeats; NaN where a job was too short to measure."""
    try:
        table = pd.read_csv(path, sep="\t", na_values=["-"])[["s", "cpu_time", "max_rss"]].astype(float)
    except (ValueError, KeyError) as error:
        raise UserError(f"{path}: not a benchmark of Snakemake ({error})") from None
    return table.mean()


def _total(values: Sequence[float], expected: int) -> float | None:
    """The sum, unless a job is missing or was not measured."""
    known = [value for value in values if not np.isnan(value)]
    return float(sum(known)) if known and len(known) == expected else None


def _printed(row: Mapping[str, Any], paper: pd.DataFrame) -> str | None:
    if row["stage"] == "train_model" and row["method"] == "tetgan":
        return quoted_figure(paper, row["category"], "training", "time")
    return None


def _preprocessing(rows: Sequence[Mapping[str, Any]], paper: pd.DataFrame) -> list[dict[str, Any]]:
    """What the paper calls preprocessing: repair and fields, for each category and grid."""
    repairs = {row["category"]: row for row in rows if row["stage"] == "repair_shapes"}
    made = []
    for fields in (row for row in rows if row["stage"] == "extract_fields"):
        both = (repairs[fields["category"]], fields)
        seconds = [row["seconds_a_shape"] for row in both if row["seconds_a_shape"] is not None]
        memory = [row["max_rss_mib"] for row in both if row["max_rss_mib"] is not None]
        made.append(
            {name: fields[name] for name in ("category", "grid")}
            | {
                "stage": "preprocess",
                "shapes": both[0]["shapes"],
                "seconds_a_shape": sum(seconds) if len(seconds) == len(both) else None,
                "max_rss_mib": max(memory, default=None),
                "paper": quoted_figure(paper, "any", "preprocessing", "time"),
            }
        )
    return made


def _render(table: pd.DataFrame) -> str:
    deviations = table["seconds_std"].map(lambda value: "" if pd.isna(value) else f" ± {round_value(value)}")
    columns = {
        "Stage": table["stage"],
        "Category": table["category"].map(plain),
        "Model or grid": table[["model", "grid", "sampling"]].apply(_first_known, axis=1),
        "Mode": table["mode"].map(plain),
        "Jobs measured": [
            "" if pd.isna(jobs) else f"{measured} of {jobs}"
            for jobs, measured in zip(table["jobs"], table["jobs_measured"], strict=True)
        ],
        "Shapes": table["shapes"].map(plain),
        "Seconds": table["seconds"].map(_figure) + deviations,
        "Seconds a shape": table["seconds_a_shape"].map(_figure),
        "CPU seconds": table["cpu_seconds"].map(_figure),
        "Peak MiB": table["max_rss_mib"].map(_figure),
        "Training, min": table["train_minutes"].map(plain),
        "Paper": table["paper"].map(plain),
    }
    return page("Time and memory", markdown_table(columns), notes=_NOTES)


def _first_known(row: pd.Series) -> str:
    return next((str(value) for value in row if not pd.isna(value)), "")


def _figure(value: float | None) -> str:
    return "—" if value is None or pd.isna(value) else round_value(value)
