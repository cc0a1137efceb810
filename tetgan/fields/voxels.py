"""Signed distance to a closed surface at the cells of the unit cube."""

import igl
import numpy as np
from jaxtyping import Float, Float32, Int

from tetgan.geometry.inside import is_inside

CLAMP = 0.1
"""Greatest distance kept, in cube sides, as ShapeGAN has it."""


def sample_distance(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], resolution: int
) -> Float32[np.ndarray, "R R R"]:
    """Signed distance at the cell centres of the unit cube, in cube sides, negative inside, within ±0.1.

    libigl's own signed distances are off by up to 0.0024, so the sign comes from the winding number and the
    size from the closest point.

    Args:
        vertices, faces: a closed surface that faces outward, in the unit cube.

    Returns:
        Indexed by x, y, z.

    Raises:
        ValueError: the mesh has no faces.
    """
    points = cell_centres(resolution).reshape(-1, 3)
    inside = is_inside(points, vertices, faces)
    vertices, faces = np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.int64)
    squared, _, _ = igl.point_mesh_squared_distance(points, vertices, faces)
    distance = np.sqrt(squared).clip(max=CLAMP)
    signed = np.where(inside, -distance, distance).astype(np.float32)
    return signed.reshape(3 * (resolution,))


def cell_centres(resolution: int) -> Float[np.ndarray, "R R R 3"]:
    """Centres of the cells of the unit cube, indexed by x, y, z."""
    along = (np.arange(resolution) + 0.5) / resolution
    return np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1)
