"""Intersection over union of a decoded and a true occupancy."""

import numpy as np
from jaxtyping import Bool, Float


def occupancy_iou(
    predicted: Bool[np.ndarray, "*batch T"], true: Bool[np.ndarray, "*batch T"]
) -> Float[np.ndarray, "*batch"]:
    """Tets in both over tets in either, for each shape; 1 where both are empty."""
    both = np.count_nonzero(predicted & true, axis=-1)
    either = np.count_nonzero(predicted | true, axis=-1)
    return np.where(either == 0, 1.0, both / np.maximum(either, 1))
