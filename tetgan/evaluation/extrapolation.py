"""FID without the bias of few samples."""

import numpy as np
from jaxtyping import Float

from tetgan.evaluation.frechet import fid
from tetgan.evaluation.intervals import Interval, recentered_interval, resample_indices

_PARTS = 4
FEWEST = 4
"""Samples of each set: two sizes, and no part of one sample."""


def fid_infinity(
    found: Float[np.ndarray, "N F"], real: Float[np.ndarray, "N F"], rng: np.random.Generator
) -> float:
    """FID extrapolated to infinitely many samples; it can be negative.

    Chong and Forsyth (2020), section 4: the bias of FID is nearly proportional to 1/N, so the line through
    FIDs at several N meets 1/N = 0 near the unbiased value. They vary the number of generated samples alone,
    against many real ones. Here both sides are few and both biased, so both are cut at random into 1, 2, 3
    and 4 disjoint parts of equal size and the FIDs of equal parts averaged: every size uses everything, and
    the sizes are evenly spaced in 1/N. The bias bends where N is less than the number of directions in which
    the features vary, so the line still falls short there; it is no cure for very few samples.

    Raises:
        ValueError: the sets differ in size, or have fewer than four samples.
    """
    if len(found) != len(real) or len(found) < FEWEST:
        raise ValueError(f"needs two sets of one size, at least {FEWEST}, not {len(found)} and {len(real)}")
    found, real = found[rng.permutation(len(found))], real[rng.permutation(len(real))]
    counts = range(1, min(_PARTS, len(found) // 2) + 1)
    sizes = [len(found) // parts for parts in counts]
    means = [
        np.mean([fid(found[i * n : (i + 1) * n], real[i * n : (i + 1) * n]) for i in range(parts)])
        for parts, n in zip(counts, sizes, strict=True)
    ]
    _, intercept = np.polyfit(1 / np.array(sizes), means, 1)
    return float(intercept)


def fid_infinity_interval(
    found: Float[np.ndarray, "N F"],
    real: Float[np.ndarray, "N F"],
    *,
    value: float,
    resamples: int,
    level: float,
    rng: np.random.Generator,
) -> Interval:
    """Bootstrap of `fid_infinity` over both sets, moved onto its `value`."""
    rows = zip(
        resample_indices(len(found), resamples, rng), resample_indices(len(real), resamples, rng), strict=True
    )
    values = np.array([fid_infinity(found[a], real[b], rng) for a, b in rows])
    return recentered_interval(value, values, level)
