"""A figure, its interval, and on how much it rests."""

from dataclasses import asdict, dataclass
from math import isnan, nan
from typing import Any

import numpy as np
from jaxtyping import Float

from tetgan.evaluation.frechet import fid, fid_interval, kid, kid_interval
from tetgan.evaluation.intervals import bootstrap_mean, student_interval
from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.seeds import named_rng


@dataclass(frozen=True)
class Estimate:
    """One metric of one model; nan where there was too little to measure.

    Attributes:
        value: the figure.
        low, high: its interval.
        n: items it rests on (meshes; for FID and KID those of each side).
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
    """FID and KID of two sets of equal size."""
    bootstrap = options.bootstrap
    fid_ends = fid_interval(
        found, real, bootstrap.frechet_resamples, bootstrap.level, named_rng(options.seed, "bootstrap", "fid")
    )
    kid_ends = kid_interval(
        found, real, bootstrap.resamples, bootstrap.level, named_rng(options.seed, "bootstrap", "kid")
    )
    distance = kid(
        found, real, options.kernel.block, options.kernel.blocks, named_rng(options.seed, "blocks")
    )
    return {
        "fid": Estimate(fid(found, real), *fid_ends, n=len(found)),
        "kid": Estimate(distance.value, *kid_ends, n=len(found), std=distance.std),
    }
