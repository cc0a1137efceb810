"""Connected components: of any graph, and of tets joined by faces."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from tetgan.geometry.adjacency import FACES, face_keys


def label_components(
    one: Int[np.ndarray, "L"], other: Int[np.ndarray, "L"], count: int
) -> Int[np.ndarray, "N"]:
    """Number of the component that each of `count` nodes belongs to; `one` and `other` are linked.

    Components are numbered from 0 in the order of their first nodes.
    """
    links = sparse.coo_array((np.ones(len(one), dtype=bool), (one, other)), shape=(count, count))
    return connected_components(links, directed=False)[1].astype(np.int64)


@dataclass(frozen=True, eq=False)
class Connectivity:
    """Tets joined by faces, of any mesh, broken ones included.

    Attributes:
        faces: (F, 3) faces of one tet only, facing away from it when the tet is positive.
        component: (T,) number of the piece, joined by faces, that each tet belongs to.
        crowded_faces: faces of more than two tets.
        folded_faces: faces of two tets that both lie on the same side of it, if both are positive: they
            overlap.
    """

    faces: Int[np.ndarray, "F 3"]
    component: Int[np.ndarray, "T"]
    crowded_faces: int
    folded_faces: int


def connect_tets(tets: Int[np.ndarray, "T 4"]) -> Connectivity:
    """Look at every face of every tet.

    Raises:
        ValueError: more than two million vertices.
    """
    corners = tets[:, FACES].reshape(-1, 3)
    _, face, counts = np.unique(face_keys(corners), return_inverse=True, return_counts=True)
    # A face that two tets leave in opposite directions turns both ways, which cancels.
    turns = np.bincount(face, weights=_turns(corners), minlength=len(counts))
    return Connectivity(
        faces=corners[counts[face] == 1],
        component=_components(face, len(tets)),
        crowded_faces=int((counts > 2).sum()),
        folded_faces=int(((counts == 2) & (turns != 0)).sum()),
    )


def _turns(corners: Int[np.ndarray, "N 3"]) -> Int[np.ndarray, "N"]:
    """1 for faces whose corners are an even permutation of their order by number, else -1."""
    a, b, c = corners.T
    ascents = (a < b).astype(np.int64) + (b < c) + (c < a)
    return np.where(ascents == 2, 1, -1)


def _components(face: Int[np.ndarray, "N"], count: int) -> Int[np.ndarray, "T"]:
    """Pieces of tets, of which number 0 has the faces 0..3, number 1 the faces 4..7, and so on."""
    order = np.argsort(face, kind="stable")
    same = np.flatnonzero(np.diff(face[order]) == 0)
    return label_components(order[same] // 4, order[same + 1] // 4, count)
