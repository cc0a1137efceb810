"""Improved precision and recall of features (Kynkäänniemi et al. 2019)."""

import numpy as np
from jaxtyping import Float
from scipy.spatial.distance import cdist

from tetgan.evaluation.coverage import TwoSets, two_sets

NEIGHBORS = 3
"""Kynkäänniemi et al. (2019), section 3.1."""


def feature_sets(found: Float[np.ndarray, "N F"], real: Float[np.ndarray, "M F"]) -> TwoSets:
    """Two sets by the Euclidean distances of their features.

    Raises:
        ValueError: a set has fewer than two.
    """
    return two_sets(cdist(found, found), cdist(real, real), cdist(found, real))


def precision_recall(sets: TwoSets) -> dict[str, float]:
    """Share of generated shapes that look real, and of real shapes that could have been generated.

    Kynkäänniemi et al. (2019), eqs. 1–2: a set occupies the balls around its members that reach to their
    third nearest neighbour in the set; precision is the share of generated features inside the balls of real
    ones, recall the share of real features inside the balls of generated ones. Both grow with the number of
    shapes where sets overlap, so only equal numbers compare.
    """
    in_real = (sets.between <= _radii(sets.real)[None, :]).any(1)
    in_generated = (sets.between <= _radii(sets.generated)[:, None]).any(0)
    return {
        "precision": float(np.average(in_real, weights=sets.generated_weights)),
        "recall": float(np.average(in_generated, weights=sets.real_weights)),
    }


def _radii(within: Float[np.ndarray, "N N"]) -> Float[np.ndarray, "N"]:
    """Distance of each member to its third nearest neighbour; infinite where there are fewer."""
    place = min(NEIGHBORS, len(within)) - 1
    return np.partition(within, place, axis=1)[:, place]
