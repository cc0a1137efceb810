"""The pieces that a tet mesh falls into, and whether each is held."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from tetgan.grids.adjacency import face_neighbors
from tetgan.studies.elasticity.assembly import rigid_motions

_LOOSE = 1e-6  # singular value, over the largest, below which a motion is free


def label_pieces(tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "T"]:
    """Number of the piece of each tet; tets of one piece are joined by faces, not by edges or vertices alone.

    Raises:
        ValueError: a face belongs to more than two tets.
    """
    neighbors = face_neighbors(tets)
    rows, slots = np.nonzero(neighbors >= 0)
    links = sparse.coo_array(
        (np.ones(len(rows), dtype=bool), (rows, neighbors[rows, slots])), shape=(len(tets),) * 2
    )
    return connected_components(links, directed=False)[1].astype(np.int64)


def largest_piece(
    vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]
) -> tuple[Float[np.ndarray, "W 3"], Int[np.ndarray, "S 4"]]:
    """The piece with the most tets, and the vertices it uses; of equal ones the first."""
    labels = label_pieces(tets)
    kept = tets[labels == np.bincount(labels).argmax()]
    used, compact = np.unique(kept, return_inverse=True)
    return vertices[used], compact.reshape(-1, 4)


def count_free_motions(points: Float[np.ndarray, "N 3"], held: Bool[np.ndarray, "N 3"]) -> int:
    """Rigid motions of a piece that its supports do not prevent, 0 to 6.

    Args:
        points: nodes of the piece.
        held: which of their components are zero.
    """
    prevented = rigid_motions(points)[held.ravel()]
    if len(prevented) == 0:
        return 6
    values = np.linalg.svd(prevented, compute_uv=False)
    return 6 - int((values > _LOOSE * values[0]).sum())
