"""Bootstrap and Student intervals of means and set measures."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.special import stdtrit  # scipy.stats would take a third of a second to import


class Interval(NamedTuple):
    """Ends of an interval; nan where too few values were there to say."""

    low: float
    high: float


def resample_indices(size: int, resamples: int, rng: np.random.Generator) -> Int[np.ndarray, "R N"]:
    """`resamples` draws of `size` items with replacement."""
    return rng.integers(size, size=(resamples, size))


def resample_counts(size: int, resamples: int, rng: np.random.Generator) -> Float[np.ndarray, "R N"]:
    """The same by how often every item is drawn."""
    return rng.multinomial(size, np.full(size, 1 / size), size=resamples).astype(np.float64)


def bootstrap_mean(
    values: Float[np.ndarray, "N"], resamples: int, level: float, rng: np.random.Generator
) -> Interval:
    """Percentile bootstrap of a mean."""
    return bootstrap(values, np.mean, resamples, level, rng)


def bootstrap(
    values: Float[np.ndarray, "N"],
    statistic: Callable[..., Any],
    resamples: int,
    level: float,
    rng: np.random.Generator,
) -> Interval:
    """Percentile bootstrap of a statistic (Efron and Tibshirani 1993, chapter 13).

    Args:
        statistic: as `np.mean` takes an array and an `axis`.
    """
    if len(values) < 2:
        return Interval(np.nan, np.nan)
    drawn = values[resample_indices(len(values), resamples, rng)]
    return percentile_interval(statistic(drawn, axis=1), level)


def percentile_interval(values: Float[np.ndarray, "R"], level: float) -> Interval:
    """The central `level` of the values."""
    low, high = np.quantile(values, [(1 - level) / 2, (1 + level) / 2])
    return Interval(float(low), float(high))


def recentered_interval(value: float, resampled: Float[np.ndarray, "R"], level: float) -> Interval:
    """Percentiles of a bootstrap, moved so that its mean lies on the value.

    A resample holds duplicates, which biases a statistic of covariances upward: its spread is right, its
    place is not.
    """
    low, high = percentile_interval(resampled, level)
    shift = value - float(resampled.mean())
    return Interval(low + shift, high + shift)


def student_interval(values: Float[np.ndarray, "N"], level: float) -> Interval:
    """Student's interval of a mean: for a handful of repeats, where the bootstrap is far too narrow."""
    if len(values) < 2:
        return Interval(np.nan, np.nan)
    half = stdtrit(len(values) - 1, (1 + level) / 2) * values.std(ddof=1) / np.sqrt(len(values))
    return Interval(float(values.mean() - half), float(values.mean() + half))
