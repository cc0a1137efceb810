"""Vertices of a lattice drawn onto a level set without a change of its topology."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse

from tetgan.geometry.adjacency import FACES, unique_edges
from tetgan.geometry.components import label_components


def snap_vertices(
    tets: Int[np.ndarray, "T 4"],
    signs: Int[np.ndarray, "V"],
    candidates: Int[np.ndarray, "C"],
    distances: Float[np.ndarray, "C"],
) -> Int[np.ndarray, "V"]:
    """Signs with 0 for the candidates that the surface between - and + can be drawn to.

    A vertex may be drawn onto the surface where that leaves the surface a disk around it: in the sphere of
    triangles opposite the vertex (its link) the negative vertices are joined in one piece, the positive ones
    too, and the zeros among them form one closed curve between the two. So thin parts, with the outside on
    both sides, keep their vertices.

    The nearest candidates come first, all at once that are not neighbours of nearer ones. A vertex with a
    neighbour among the zeros that would not be a disk any more stays what it is.

    Args:
        tets: all that touch a candidate; around each they close up to a ball.
        signs: -1 or 1 of each vertex.
        distances: of the candidates from the surface.
    """
    signs = signs.copy()
    is_candidate = np.zeros(len(signs), dtype=bool)
    is_candidate[candidates] = True
    tets = tets[is_candidate[tets].any(axis=1)]
    stars = _Stars(tets, is_candidate)
    edges, _ = unique_edges(tets)
    neighbours = _adjacency(edges, len(signs))
    rank = np.full(len(signs), np.inf)
    rank[candidates[np.argsort(distances, kind="stable")]] = np.arange(len(candidates))
    waiting = rank < np.inf
    while True:
        waiting &= _beside_the_other_sign(edges, signs)
        left = np.flatnonzero(waiting)
        if len(left) == 0:
            return signs
        around, owner = _rows(neighbours, left)
        nearest = np.full(len(left), np.inf)
        np.minimum.at(nearest, owner, np.where(waiting[around], rank[around], np.inf))
        chosen = left[rank[left] < nearest]
        before = signs[chosen]
        signs[chosen] = 0
        around, owner = _rows(neighbours, chosen)
        touched = np.union1d(chosen, around[signs[around] == 0])
        spoiled = np.zeros(len(signs), dtype=bool)
        spoiled[touched[~stars.on_disk(touched, signs)]] = True
        undone = spoiled[chosen]
        np.logical_or.at(undone, owner, spoiled[around])
        signs[chosen[undone]] = before[undone]
        waiting[chosen] = False


class _Stars:
    """The links of some vertices: what lies opposite each in the tets around it."""

    def __init__(self, tets: Int[np.ndarray, "T 4"], of: Bool[np.ndarray, "V"]) -> None:
        vertices, (rows, slots) = len(of), np.nonzero(of[tets])
        order = np.argsort(tets[rows, slots], kind="stable")
        rows, slots = rows[order], slots[order]
        self._faces = _Ranges.of(tets[rows, slots], vertices)
        keys = tets[rows, slots][:, None] * vertices + tets[rows[:, None], FACES[slots]]
        keys, corners = np.unique(keys, return_inverse=True)
        self._corners = corners.reshape(-1, 3)  # of each face, among all vertices of all links
        self._around = keys % vertices
        self._vertices = _Ranges.of(keys // vertices, vertices)

    def on_disk(self, vertices: Int[np.ndarray, "N"], signs: Int[np.ndarray, "V"]) -> Bool[np.ndarray, "N"]:
        """Whether the level set through each of some vertices is a disk there; see `snap_vertices`."""
        faces, owner = self._faces.rows(vertices)
        around, place = self._vertices.rows(vertices)
        first = np.searchsorted(place, np.arange(len(vertices)))
        corners = self._corners[faces] - (self._vertices.begin[vertices] - first)[owner, None]
        sign = signs[self._around[around]]
        wrong = np.zeros(len(vertices), dtype=bool)
        wrong[owner[(sign[corners] == 0).all(axis=1)]] = True
        sides = corners[:, [[0, 1], [0, 2], [1, 2]]].reshape(-1, 2)
        third = sign[corners[:, [2, 1, 0]]].ravel()
        one, other = sign[sides].T
        alike = (one == other) & (one != 0)
        start, end = sides[alike].T
        piece = label_components(start, end, len(place))
        for side in (-1, 1):
            of_piece = np.full(len(place), -1)
            of_piece[piece[sign == side]] = place[sign == side]
            wrong |= np.bincount(of_piece[of_piece >= 0], minlength=len(vertices)) != 1
        # A zero lies between the two sides, and so does an edge of two zeros.
        beside = np.zeros((2, len(place)), dtype=bool)
        for ends, facing in ((sides[:, 0], other), (sides[:, 1], one)):
            beside[0, ends[facing < 0]] = True
            beside[1, ends[facing > 0]] = True
        wrong[place[(sign == 0) & ~beside.all(axis=0)]] = True
        flat = (one == 0) & (other == 0)
        ends = np.sort(sides[flat], axis=1)
        edges, number = np.unique(ends[:, 0] * len(place) + ends[:, 1], return_inverse=True)
        sums, sizes = np.zeros((2, len(edges)), dtype=np.int64)
        np.add.at(sums, number, third[flat])
        np.add.at(sizes, number, np.abs(third[flat]))
        wrong[place[edges[(sums != 0) | (sizes != 2)] // len(place)]] = True
        return ~wrong


class _Ranges(NamedTuple):
    """Ranges of rows, one for each of some things."""

    begin: Int[np.ndarray, "N"]
    end: Int[np.ndarray, "N"]

    @classmethod
    def of(cls, owners: Int[np.ndarray, "R"], count: int) -> "_Ranges":
        """The rows of each owner, which are sorted by it."""
        bounds = np.searchsorted(owners, np.arange(count + 1))
        return cls(bounds[:-1], bounds[1:])

    def rows(self, chosen: Int[np.ndarray, "C"]) -> tuple[Int[np.ndarray, "M"], Int[np.ndarray, "M"]]:
        """The rows of some of the things, one after the other, and which of the chosen each belongs to."""
        counts = self.end[chosen] - self.begin[chosen]
        owner = np.repeat(np.arange(len(chosen)), counts)
        before = np.cumsum(counts) - counts
        return np.arange(counts.sum()) + (self.begin[chosen] - before)[owner], owner


def _adjacency(edges: Int[np.ndarray, "E 2"], vertices: int) -> sparse.csr_array:
    one, other = np.concatenate([edges, edges[:, ::-1]]).T
    return sparse.csr_array((np.ones(len(one), dtype=bool), (one, other)), shape=(vertices, vertices))


def _rows(
    matrix: sparse.csr_array, rows: Int[np.ndarray, "N"]
) -> tuple[Int[np.ndarray, "M"], Int[np.ndarray, "M"]]:
    """The columns of some rows, and which of the rows each belongs to."""
    places, owner = _Ranges(matrix.indptr[:-1], matrix.indptr[1:]).rows(rows)
    return matrix.indices[places], owner


def _beside_the_other_sign(
    edges: Int[np.ndarray, "E 2"], signs: Int[np.ndarray, "V"]
) -> Bool[np.ndarray, "V"]:
    beside, (one, other) = np.zeros(len(signs), dtype=bool), signs[edges.T]
    beside[edges[one * other < 0]] = True
    return beside
