"""Figures that tell how well-shaped tets are."""

import numpy as np
from jaxtyping import Float, Int

from tetgan.grids.adjacency import EDGES, FACES


def dihedral_angles(
    vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]
) -> Float[np.ndarray, "T 6"]:
    """Angles in degrees between the two faces at each edge, in the order of `EDGES`.

    A tet flattened to a plane has angles of 0 and 180; at a face without area the angle is 0.
    """
    corners = vertices[tets[:, FACES]]
    normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    # Faces i and j meet at the edge that has neither of the vertices i and j: the opposite one in EDGES.
    one, other = np.moveaxis(normals[:, EDGES[::-1]], 2, 0)
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    cosine = -np.einsum("tec,tec->te", one, other)
    return np.degrees(np.where(one.any(axis=-1) & other.any(axis=-1), np.arctan2(sine, cosine), 0.0))


def radius_ratios(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> Float[np.ndarray, "T"]:
    """Three times the radius of the inscribed sphere over that of the circumscribed one.

    1 for a regular tet, 0 for a flat one; like the angles it does not see whether a tet is inverted.
    """
    corners = vertices[tets]
    one, two, three = np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 0)
    sides = corners[:, FACES]
    areas = np.linalg.norm(np.cross(sides[:, :, 1] - sides[:, :, 0], sides[:, :, 2] - sides[:, :, 0]), axis=2)
    crosses = np.cross(two, three), np.cross(three, one), np.cross(one, two)
    squares = ((edge**2).sum(axis=1)[:, None] for edge in (one, two, three))
    # With v six times the volume: inner radius v / sum(areas), outer |w| / 2v; areas are doubled here.
    w = np.linalg.norm(sum(square * cross for square, cross in zip(squares, crosses, strict=True)), axis=1)
    v = (one * crosses[0]).sum(axis=1)
    below = areas.sum(axis=1) * w
    return np.divide(6 * v**2, below, out=np.zeros_like(v), where=below > 0)
