"""How thick a solid is, seen from its surface."""

import numpy as np
from jaxtyping import Float, Int

from tetgan.shapes.rays import Visibility

_INWARD = 1e-5  # where rays start behind their face, in cube sides: clear of it in single precision


def median_thickness(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]) -> float:
    """Thickness that half of the surface has no more of.

    The thickness behind a face is the length of the straight way from its centroid through the solid, against
    its normal: the shape diameter of Shapira et al. (2008) with one ray. The faces' median is weighted by
    area, so a thin plate is as thick as it is between its two sides: the rays from its narrow rim run through
    the whole of it, and would lift a mean to three times as much. A ball has its diameter.

    Args:
        faces: a closed surface that faces outward. Rays of faces that inverted tets turned over may lead
            nowhere; they do not count.

    Returns:
        Thickness in the unit of the vertices; 0 without faces or where no ray meets anything.
    """
    if len(faces) == 0:
        return 0.0
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled_areas = np.linalg.norm(normals, axis=1)
    inward = -normals / np.maximum(doubled_areas, np.finfo(float).tiny)[:, None]
    lengths = Visibility(corners).distances(corners.mean(axis=1) + _INWARD * inward, inward) + _INWARD
    counted = np.isfinite(lengths) & (doubled_areas > 0)
    return _weighted_median(lengths[counted], doubled_areas[counted])


def _weighted_median(values: Float[np.ndarray, "N"], weights: Float[np.ndarray, "N"]) -> float:
    """The smallest value up to which lies half of the weight; 0 without values."""
    if len(values) == 0:
        return 0.0
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(below, below[-1] / 2)])
