"""Estimates: a value, its interval, and the number of shapes behind it."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from math import inf, isnan, nan
from typing import Any

import numpy as np
from jaxtyping import Float

from tetgan.evaluation.coverage import TwoSets, bootstrap_measures, set_measures
from tetgan.evaluation.fid import (
    FEWEST,
    fid,
    fid_infinity,
    fid_infinity_interval,
    fid_interval,
    kid,
    kid_interval,
)
from tetgan.evaluation.intervals import bootstrap_mean, student_interval
from tetgan.evaluation.jsd import jsd, jsd_interval
from tetgan.evaluation.metrics import BY_NAME
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.precision_recall import feature_sets, precision_recall
from tetgan.evaluation.seeds import named_rng


@dataclass(frozen=True)
class Estimate:
    """One metric of one model; nan where there was too little to measure.

    Attributes:
        value: the figure.
        low, high: its interval.
        n: items it rests on (meshes; of two sets those of each).
        std: deviation over repeats (variety) or blocks (KID).
    """

    value: float = nan
    low: float = nan
    high: float = nan
    n: int = 0
    std: float = nan

    def to_json(self) -> dict[str, Any]:
        """Plain values; missing ones are None."""
        return {
            key: None if isinstance(value, float) and isnan(value) else value
            for key, value in asdict(self).items()
        }


def mean_estimate(values: Float[np.ndarray, "N"], name: str, options: EvaluationOptions) -> Estimate:
    """Mean over items; their bootstrap."""
    if not len(values):
        return Estimate()
    bootstrap = options.bootstrap
    interval = bootstrap_mean(
        values, bootstrap.resamples, bootstrap.level, named_rng(options.seed, "bootstrap", name)
    )
    return Estimate(float(values.mean()), *interval, n=len(values))


def repeats_estimate(values: Float[np.ndarray, "R"], n: int, options: EvaluationOptions) -> Estimate:
    """Mean over repeats; Student's interval."""
    interval = student_interval(values, options.bootstrap.level)
    std = float(values.std(ddof=1)) if len(values) > 1 else nan
    return Estimate(float(values.mean()), *interval, n=n, std=std)


def feature_estimates(
    found: Float[np.ndarray, "N F"], real: Float[np.ndarray, "N F"], options: EvaluationOptions
) -> dict[str, Estimate]:
    """Metrics of the group `features`, of two sets of equal size."""
    sets = feature_sets(found, real)
    return {
        "fid": _fid_estimate(found, real, options),
        "kid": _kid_estimate(found, real, options),
        "fid_infinity": _fid_infinity_estimate(found, real, options),
        **_measure_estimates(precision_recall, sets, "features", options),
    }


def set_estimates(sets: TwoSets, options: EvaluationOptions) -> dict[str, Estimate]:
    """MMD, COV and 1-NNA of two sets of equal size by their Chamfer distances."""
    return _measure_estimates(set_measures, sets, "sets", options)


def jsd_estimate(
    found: Float[np.ndarray, "N P 3"], real: Float[np.ndarray, "N P 3"], options: EvaluationOptions
) -> Estimate:
    """JSD of two sets of equal size."""
    bootstrap = options.bootstrap
    rng = named_rng(options.seed, "bootstrap", "jsd")
    low, high = jsd_interval(found, real, bootstrap.frechet_resamples, bootstrap.level, rng)
    return Estimate(jsd(found, real), max(low, 0.0), min(high, 1.0), n=len(found))


def _fid_estimate(
    found: Float[np.ndarray, "N F"], real: Float[np.ndarray, "N F"], options: EvaluationOptions
) -> Estimate:
    bootstrap = options.bootstrap
    rng = named_rng(options.seed, "bootstrap", "fid")
    ends = fid_interval(found, real, bootstrap.frechet_resamples, bootstrap.level, rng)
    return Estimate(fid(found, real), *ends, n=len(found))


def _kid_estimate(
    found: Float[np.ndarray, "N F"], real: Float[np.ndarray, "N F"], options: EvaluationOptions
) -> Estimate:
    bootstrap, kernel = options.bootstrap, options.kernel
    rng = named_rng(options.seed, "bootstrap", "kid")
    ends = kid_interval(found, real, bootstrap.resamples, bootstrap.level, rng)
    distance = kid(found, real, kernel.block, kernel.blocks, named_rng(options.seed, "blocks"))
    # Blocks of everything are all one block: their deviation of 0 says nothing.
    std = distance.std if kernel.block < len(found) else nan
    return Estimate(distance.value, *ends, n=len(found), std=std)


def _fid_infinity_estimate(
    found: Float[np.ndarray, "N F"], real: Float[np.ndarray, "N F"], options: EvaluationOptions
) -> Estimate:
    """Missing where there are too few to cut."""
    if len(found) < FEWEST:
        return Estimate()
    bootstrap = options.bootstrap
    value = fid_infinity(found, real, named_rng(options.seed, "parts"))
    ends = fid_infinity_interval(
        found,
        real,
        value=value,
        resamples=bootstrap.frechet_resamples,
        level=bootstrap.level,
        rng=named_rng(options.seed, "bootstrap", "fid_infinity"),
    )
    return Estimate(value, *ends, n=len(found))


def _measure_estimates(
    measure: Callable[[TwoSets], Mapping[str, float]], sets: TwoSets, name: str, options: EvaluationOptions
) -> dict[str, Estimate]:
    """Measures of two sets, each within its bounds."""
    bootstrap = options.bootstrap
    rng = named_rng(options.seed, "bootstrap", name)
    ends = bootstrap_measures(measure, sets, bootstrap.resamples, bootstrap.level, rng)
    return {
        metric: Estimate(
            value,
            max(ends[metric].low, 0.0),
            min(ends[metric].high, 1.0 if BY_NAME[metric].share else inf),
            n=len(sets.generated),
        )
        for metric, value in measure(sets).items()
    }
