"""Jensen–Shannon divergence of the surface points of two sets, counted in cells."""

import numpy as np
from jaxtyping import Float

from tetgan.evaluation.intervals import Interval, recentered_interval, resample_counts

CELLS = 28
"""Cells along a side of the unit cube (Achlioptas et al. 2018, section 3)."""


def cell_counts(clouds: Float[np.ndarray, "N P 3"]) -> Float[np.ndarray, "N K"]:
    """Points of every cloud in each of the 28³ cells of the unit cube.

    A point outside the cube counts in the cell nearest to it.
    """
    cell = np.clip((clouds * CELLS).astype(np.int64), 0, CELLS - 1)
    place = (cell[..., 0] * CELLS + cell[..., 1]) * CELLS + cell[..., 2]
    return np.stack([np.bincount(each, minlength=CELLS**3) for each in place]).astype(np.float64)


def jensen_shannon(first: Float[np.ndarray, "K"], second: Float[np.ndarray, "K"]) -> float:
    """Divergence in bits of two histograms, each scaled to sum to 1: 0 where they agree, 1 where they are
    nowhere both above 0."""
    p, q = first / first.sum(), second / second.sum()
    return max(0.0, _entropy((p + q) / 2) - (_entropy(p) + _entropy(q)) / 2)


def jsd(first: Float[np.ndarray, "N P 3"], second: Float[np.ndarray, "M P 3"]) -> float:
    """JSD of two sets of clouds: of their points' distributions over the cells, all shapes of a set together.

    Achlioptas et al. (2018), section 3. It sees where shapes are, not what shapes there are: a set of one
    average shape can do well. Few points or shapes raise it, so only equal numbers compare.
    """
    return jensen_shannon(cell_counts(first).sum(0), cell_counts(second).sum(0))


def jsd_interval(
    first: Float[np.ndarray, "N P 3"],
    second: Float[np.ndarray, "M P 3"],
    resamples: int,
    level: float,
    rng: np.random.Generator,
) -> Interval:
    """Bootstrap over the shapes of both sets, moved onto the value because fewer shapes raise it."""
    counts = [cell_counts(clouds) for clouds in (first, second)]
    occupied = sum(each.sum(0) for each in counts) > 0
    histograms = [resample_counts(len(each), resamples, rng) @ each[:, occupied] for each in counts]
    values = np.array([jensen_shannon(a, b) for a, b in zip(*histograms, strict=True)])
    return recentered_interval(jsd(first, second), values, level)


def _entropy(p: Float[np.ndarray, "K"]) -> float:
    known = p[p > 0]
    return float(-(known * np.log2(known)).sum())
