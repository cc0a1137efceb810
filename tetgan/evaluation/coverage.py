"""MMD, COV and 1-NNA from the distances within and between two sets."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from tetgan.evaluation.intervals import Interval, recentered_interval, resample_counts


class TwoSets(NamedTuple):
    """Generated (N) and real shapes (M) by their distances, of any kind that defines a nearest one.

    Attributes:
        generated, real: within a set; infinite on the diagonal, so that no shape is its own neighbour.
        between: from every generated shape to every real one.
        generated_weights, real_weights: how often each shape counts: once, or as a resample has it.
    """

    generated: Float[np.ndarray, "N N"]
    real: Float[np.ndarray, "M M"]
    between: Float[np.ndarray, "N M"]
    generated_weights: Float[np.ndarray, "N"]
    real_weights: Float[np.ndarray, "M"]

    def resample(self, rng: np.random.Generator) -> "TwoSets":
        """Both sets drawn anew with replacement.

        A shape drawn several times counts several times, but is never the neighbour of its own copy.
        """
        n, m = self.between.shape
        first, second = resample_counts(n, 1, rng)[0], resample_counts(m, 1, rng)[0]
        i, j = np.flatnonzero(first), np.flatnonzero(second)
        return TwoSets(
            self.generated[np.ix_(i, i)],
            self.real[np.ix_(j, j)],
            self.between[np.ix_(i, j)],
            first[i],
            second[j],
        )


def two_sets(
    generated: Float[np.ndarray, "N N"], real: Float[np.ndarray, "M M"], between: Float[np.ndarray, "N M"]
) -> TwoSets:
    """Two sets in which every shape counts once; the diagonals given play no part.

    Raises:
        ValueError: a set has fewer than two shapes.
    """
    if min(between.shape) < 2:
        raise ValueError(f"sets are compared by neighbours: two shapes each, not {between.shape}")
    n, m = between.shape
    return TwoSets(_without_itself(generated), _without_itself(real), between, np.ones(n), np.ones(m))


def _without_itself(within: Float[np.ndarray, "N N"]) -> Float[np.ndarray, "N N"]:
    distances = np.array(within, dtype=np.float64)
    np.fill_diagonal(distances, np.inf)
    return distances


def bootstrap_measures(
    measure: Callable[[TwoSets], Mapping[str, float]],
    sets: TwoSets,
    resamples: int,
    level: float,
    rng: np.random.Generator,
) -> dict[str, Interval]:
    """Bootstrap over both sets, moved onto each value: with fewer distinct shapes neighbours lie farther."""
    drawn = [measure(sets.resample(rng)) for _ in range(resamples)]
    return {
        name: recentered_interval(value, np.array([each[name] for each in drawn]), level)
        for name, value in measure(sets).items()
    }


def set_measures(sets: TwoSets) -> dict[str, float]:
    """The three measures by their column's name."""
    return {
        "mmd": minimum_matching_distance(sets),
        "cov": coverage(sets),
        "nna": nearest_neighbor_accuracy(sets),
    }


def minimum_matching_distance(sets: TwoSets) -> float:
    """MMD (Achlioptas et al. 2018, section 3): distance to the nearest generated shape, mean over real ones.

    Low where every real shape has a likeness; a generator of few good shapes and much rubbish still does
    well. Falls as more are generated, so only equal numbers compare.
    """
    return float(np.average(sets.between.min(0), weights=sets.real_weights))


def coverage(sets: TwoSets) -> float:
    """COV (the same): share of real shapes that are the nearest real one of some generated shape.

    High where the generated shapes spread over the real ones, whether or not they are close to them.
    """
    covered = np.zeros(len(sets.real))
    covered[sets.between.argmin(1)] = 1
    return float(np.average(covered, weights=sets.real_weights))


def nearest_neighbor_accuracy(sets: TwoSets) -> float:
    """1-NNA (Lopez-Paz and Oquab 2017; Yang et al. 2019, section 5): leave-one-out accuracy of a classifier
    that gives each shape the set of its nearest neighbour among all others.

    1/2 where both sets are drawn from one distribution; 1 where they are apart; below 1/2 where generated
    shapes are copies of the real ones, and 0 for equal sets. A neighbour of either kind at the same distance
    is half right.
    """
    right = np.concatenate(
        [_own(sets.generated.min(1), sets.between.min(1)), _own(sets.real.min(1), sets.between.min(0))]
    )
    return float(np.average(right, weights=np.concatenate([sets.generated_weights, sets.real_weights])))


def _own(own: np.ndarray, other: np.ndarray) -> np.ndarray:
    """How right the nearest neighbour's set is, from the distances to the nearest of each set."""
    return np.where(own == other, 0.5, own < other)
