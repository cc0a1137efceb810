"""Occupancy of a closed surface at random points."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from tetgan.geometry.inside import is_inside


def draw_points(
    vertices: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    count: int,
    box: float,
    seed: int | Sequence[int],
) -> tuple[Float32[np.ndarray, "N 3"], Bool[np.ndarray, "N"]]:
    """Points uniform in a cube of side `box` about the centre of the unit cube, and which lie inside.

    Coordinates are rounded to half precision, which stores keep, before the surface is asked: occupancy is
    that of the very points returned. Inside is a winding number above ½, as for fields.

    Args:
        vertices, faces: a closed surface that faces outward, in the unit cube.

    Raises:
        ValueError: the mesh has no faces.
    """
    draws = np.random.default_rng(seed).random((count, 3))
    points = (0.5 + box * (draws - 0.5)).astype(np.float16).astype(np.float64)
    return points.astype(np.float32), is_inside(points, vertices, faces)
