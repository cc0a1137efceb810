"""Hollows that a closed surface encloses."""

import igl
import numpy as np
from jaxtyping import Float, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from tetgan.grids.adjacency import unique_edges


def count_voids(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]) -> int:
    """Hollows inside an outward-facing surface.

    A hollow is a part of the surface, joined by edges, that faces inward (its signed volume is negative) and
    lies inside the other parts (their winding number about it is above ½): an inverted tet that floats
    outside is none. A hollow that touches the outside along an edge is not told apart from it.
    """
    if not len(faces):
        return 0
    part = _parts(faces)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    volumes = np.bincount(part, np.einsum("fc,fc->f", a, np.cross(b, c)))
    return sum(_is_inside(vertices, faces, part == number) for number in np.flatnonzero(volumes < 0))


def _parts(faces: Int[np.ndarray, "F 3"]) -> Int[np.ndarray, "F"]:
    """Number of the part that each face belongs to."""
    edges, edge_of_side = unique_edges(faces)
    rows = np.repeat(np.arange(len(faces)), 3)
    incidence = sparse.csr_array(
        (np.ones(len(rows)), (rows, edge_of_side.ravel())), shape=(len(faces), len(edges))
    )
    return connected_components(incidence @ incidence.T, directed=False)[1].astype(np.int64)


def _is_inside(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], part: np.ndarray) -> bool:
    """Whether a part of the faces lies inside the others."""
    if part.all():
        return False
    middle = vertices[faces[part]].mean(axis=(0, 1))[None]
    return bool(igl.winding_number(vertices, faces[~part], middle)[0] > 0.5)
