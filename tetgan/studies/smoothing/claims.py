"""The paper's statements on smoothing, each as a measurable difference."""

from typing import NamedTuple

import numpy as np

from tetgan.evaluation.estimates import mean_estimate
from tetgan.studies.smoothing.files import Study
from tetgan.studies.smoothing.smoothers import Variant


class Claim(NamedTuple):
    """A statement that `figure` of one variant is above (`sign` 1) or below (-1) that of another."""

    statement: str
    figure: str
    sign: int
    one: Variant
    other: Variant


class Finding(NamedTuple):
    """Mean difference over the same shapes, its interval, and what it says of the claim."""

    difference: float
    low: float
    high: float
    holds: str


_NONE, _WLS, _UNIFORM, _COTANGENT = (
    Variant(True, smoothing) for smoothing in ("none", "wls", "uniform", "cotangent")
)

CLAIMS = (
    Claim("wLS bends more sharply than cotangent (95th percentile)", "bend_p95", 1, _WLS, _COTANGENT),
    Claim("wLS has more sharp edge than cotangent", "bend_sharp", 1, _WLS, _COTANGENT),
    Claim("wLS keeps closer to the shape's creases than cotangent", "crease_distance", -1, _WLS, _COTANGENT),
    Claim("wLS keeps closer to the shape's creases than plain", "crease_distance", -1, _WLS, _UNIFORM),
    Claim("wLS thins: it takes volume away", "volume_to_repaired", -1, _WLS, _NONE),
    Claim("wLS thins more than cotangent", "volume_to_repaired", -1, _WLS, _COTANGENT),
    Claim("wLS bends more like the shape than no smoothing", "bend_w1", -1, _WLS, _NONE),
    Claim("wLS lies closer to the shape than no smoothing", "chamfer", -1, _WLS, _NONE),
)


def weigh_claim(claim: Claim, study: Study) -> Finding:
    """Compare two variants shape by shape.

    Returns:
        `holds` is 'yes' or 'no' where the interval of the mean difference leaves zero out, else 'undecided'.
    """
    one, other = (study.of(variant)[claim.figure] for variant in (claim.one, claim.other))
    values = (one - other).dropna().to_numpy(dtype=np.float64)
    estimate = mean_estimate(values, claim.statement, study.evaluation)
    return _judge(estimate.value, estimate.low, estimate.high, claim.sign)


def weigh_features(metric: str, study: Study) -> Finding:
    """Whether the paper's smoothing raises FID or KID; decided where the two intervals do not touch."""
    before, after = (
        {key: np.nan if value is None else value for key, value in estimate.items()}
        for estimate in (study.report["features"][variant.name][metric] for variant in (_NONE, _WLS))
    )
    return _judge(
        after["value"] - before["value"], after["low"] - before["high"], after["high"] - before["low"], 1
    )


def _judge(difference: float, low: float, high: float, sign: int) -> Finding:
    if low > 0 or high < 0:
        return Finding(difference, low, high, "yes" if sign * difference > 0 else "no")
    return Finding(difference, low, high, "undecided")
