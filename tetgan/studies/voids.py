"""Hollows that a closed surface encloses."""

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from tetgan.grids.adjacency import unique_edges


def count_voids(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]) -> int:
    """Parts of an outward-facing surface that bound a hollow: their signed volume is negative.

    Parts are joined by edges, so a hollow that touches the outside along an edge is not told apart from it.
    """
    if not len(faces):
        return 0
    edges, edge_of_side = unique_edges(faces)
    rows = np.repeat(np.arange(len(faces)), 3)
    incidence = sparse.csr_array(
        (np.ones(len(rows)), (rows, edge_of_side.ravel())), shape=(len(faces), len(edges))
    )
    _, part = connected_components(incidence @ incidence.T, directed=False)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    volumes = np.bincount(part, np.einsum("fc,fc->f", a, np.cross(b, c)))
    return int((volumes < 0).sum())
