"""MMD, COV and 1-NNA: how well one set of shapes stands for another, by nearest neighbours."""

import numpy as np

from tetgan.evaluation.twosets import TwoSets


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
