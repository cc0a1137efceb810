"""Normalisation of a shape to the unit cube."""

import numpy as np
from jaxtyping import Float


def normalise(vertices: Float[np.ndarray, "V 3"], margin: float) -> Float[np.ndarray, "V 3"]:
    """Bounding box centred in the unit cube, its longest side 1 - 2 `margin`.

    Vertices that no face uses count too; `clean_mesh` removes them.

    Raises:
        ValueError: the vertices do not span a box, or no room is left between the margins.
    """
    if not 0 <= margin < 0.5:
        raise ValueError(f"margin {margin} is not in [0, 0.5)")
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    longest = (high - low).max()
    if not longest > 0:
        raise ValueError("the vertices do not span a box")
    return 0.5 + (vertices - (low + high) / 2) * ((1 - 2 * margin) / longest)
