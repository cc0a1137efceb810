"""Stage: the smoothing studies of all models in one table, with the paper's claims tested."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tetgan.errors import UserError
from tetgan.evaluation.estimates import mean_estimate
from tetgan.evaluation.options import EvaluationOptions
from tetgan.studies.smoothing.files import REPAIRED, VARIANTS, Study, read_study
from tetgan.studies.smoothing.report import render_smoothing
from tetgan.tables.markdown import write_twins

IDENTITY = (
    "category",
    "model",
    "grid",
    "tets",
    "displaced",
    "smoothing",
    "beta",
    "seeds",
    "n",
    "samples",
    "extractor",
)
"""First columns. Of each seed: `n` validation shapes compared, `samples` surfaces a side of FID and KID."""

FIGURES = (
    "chamfer",
    "fid",
    "kid",
    "volume_ratio",
    "volume_to_repaired",
    "bend_p95",
    "bend_sharp",
    "bend_w1",
    "crease_distance",
    "manifold_edges",
    "inverted_tets",
)
"""Each followed by its deviation over seeds, `_std`, and the ends of its interval, `_low` and `_high`."""


def tabulate_smoothing(studies: Sequence[Path], out: Path) -> None:
    """Write the table as CSV and, with what it says of the paper's claims, as Markdown beside it.

    Args:
        studies: folders that `measure_smoothing` wrote, one for each model and seed.

    Raises:
        UserError: there is none, or one that is not whole.
    """
    if not studies:
        raise UserError(f"{out}: no study of a model; name one under studies.smoothing.models")
    loaded = [read_study(folder) for folder in studies]
    table = over_seeds(pd.concat([study_table(study) for study in loaded], ignore_index=True))
    write_twins(table, render_smoothing(table, loaded), out)


def over_seeds(rows: pd.DataFrame) -> pd.DataFrame:
    """Rows of several seeds as one: means of figures and of the ends of their intervals."""
    keys = [name for name in IDENTITY if name not in {"seeds", "n", "samples"}]
    groups = rows.groupby(keys, sort=False, dropna=False)
    table = groups[[name for name in rows if name not in IDENTITY]].mean()
    table[[f"{figure}_std" for figure in FIGURES]] = groups[list(FIGURES)].std().to_numpy()
    table = table.assign(seeds=groups.size(), n=groups["n"].min(), samples=groups["samples"].min())
    ends = ("", "_std", "_low", "_high")
    columns = [*IDENTITY, *(f"{figure}{end}" for figure in FIGURES for end in ends)]
    kinds = dict.fromkeys(("tets", "seeds", "n", "samples"), "Int64") | {"displaced": "boolean"}
    return table.reset_index()[columns].astype(kinds)


def study_table(study: Study) -> pd.DataFrame:
    """One row per variant of one model, then the repaired shapes; missing is empty."""
    report, evaluation = study.report, study.evaluation
    shared = {name: report.get(name) for name in ("category", "model", "grid", "tets")}
    shared |= {"beta": report["meshing"]["beta"]}
    measured = {"samples": report["samples"], "extractor": report["extractor"]}
    lines = []
    for variant in VARIANTS:
        line = shared | measured | {"displaced": variant.displaced, "smoothing": variant.smoothing}
        line |= _means(study.of(variant), evaluation)
        for metric, estimate in report["features"][variant.name].items():
            line |= {
                f"{metric}{end}": estimate[key]
                for end, key in (("", "value"), ("_low", "low"), ("_high", "high"))
            }
        lines.append(line)
    lines.append(shared | {"smoothing": REPAIRED} | _means(study.of_repaired(), evaluation))
    figures = [f"{figure}{end}" for figure in FIGURES for end in ("", "_low", "_high")]
    columns = [*(name for name in IDENTITY if name != "seeds"), *figures]
    return pd.DataFrame(lines, columns=columns).astype(dict.fromkeys(figures, float))


def _means(rows: pd.DataFrame, evaluation: EvaluationOptions) -> dict[str, Any]:
    """Mean over shapes and its interval, of every figure there is."""
    line: dict[str, Any] = {"n": int(rows["chamfer"].notna().sum())}
    for figure in (name for name in FIGURES if name in rows):
        values = rows[figure].dropna().to_numpy(dtype=np.float64)
        estimate = mean_estimate(values, figure, evaluation)
        line |= {figure: estimate.value, f"{figure}_low": estimate.low, f"{figure}_high": estimate.high}
    return line
