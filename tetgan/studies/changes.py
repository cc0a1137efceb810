"""Where one surface is away from another."""

import igl
import numpy as np
from jaxtyping import Bool

from tetgan.evaluation.surfaces import Surface


def changed_faces(surface: Surface, other: Surface | None, threshold: float) -> Bool[np.ndarray, "F"]:
    """Faces whose centres lie further than `threshold` from the other surface; all, if there is none."""
    if other is None:
        return np.ones(len(surface.faces), dtype=bool)
    centres = surface.vertices[surface.faces].mean(axis=1)
    squared, _, _ = igl.point_mesh_squared_distance(centres, other.vertices, other.faces)
    return np.sqrt(squared) > threshold
