"""Tets of a body-centred cubic lattice, cut where a function changes its sign."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int


class CutTets(NamedTuple):
    """Both sides of a cut.

    Attributes:
        edges: (E, 2) the edges that are cut; a node on edge e has the number V + e.
        inside, outside: (I, 4), (O, 4) tets on vertices and nodes, of either orientation.
    """

    edges: Int[np.ndarray, "E 2"]
    inside: Int[np.ndarray, "I 4"]
    outside: Int[np.ndarray, "O 4"]


def cut_tets(
    tets: Int[np.ndarray, "T 4"], signs: Int[np.ndarray, "V"], points: Int[np.ndarray, "V 3"]
) -> CutTets:
    """Cut each tet of both signs into tets of one.

    Where a face is cut, one side of it is a quadrilateral on an edge ab whose ends have one sign, and its
    diagonal starts at the end that is *like* the third corner c: of an edge between a corner and a centre of
    lattice cells at the end that is a corner as c is, or a centre; of an edge between two corners or two
    centres, which are two half cells apart along one axis, at the end with the parity of c (`_halves`). Both
    tets at the face see the same, and no tet's diagonals go round in a circle. With nodes halfway along their
    edges every dihedral angle is then between 25.3 and 135 degrees, in every case there is (a test goes
    through them): the least is acos(7 / sqrt 60).

    Args:
        signs: -1, 0 or 1 of each vertex; no tet has four zeros.
        points: (V, 3) vertices in half cells: all even at corners of cells, all odd at centres.
    """
    sign = signs[tets]
    mixed = (sign < 0).any(axis=1) & (sign > 0).any(axis=1)
    nodes = _Nodes(tets[mixed], signs)
    inside, outside = (
        np.concatenate(
            [tets[((side * sign) <= 0).all(axis=1)], *_pieces(tets[mixed], side * signs, points, nodes)]
        )
        for side in (1, -1)
    )
    return CutTets(nodes.edges, inside, outside)


class _Nodes:
    """Numbers of the nodes on cut edges."""

    def __init__(self, tets: Int[np.ndarray, "T 4"], signs: Int[np.ndarray, "V"]) -> None:
        self._vertices = len(signs)
        ends = np.sort(tets[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]].reshape(-1, 2), axis=1)
        ends = ends[signs[ends].prod(axis=1) < 0]
        self._keys = np.unique(ends[:, 0] * self._vertices + ends[:, 1])

    @property
    def edges(self) -> Int[np.ndarray, "E 2"]:
        return np.stack(np.divmod(self._keys, self._vertices), axis=1)

    def __call__(self, a: Int[np.ndarray, "N"], b: Int[np.ndarray, "N"]) -> Int[np.ndarray, "N"]:
        key = np.minimum(a, b) * self._vertices + np.maximum(a, b)
        return self._vertices + np.searchsorted(self._keys, key)


def _pieces(
    tets: Int[np.ndarray, "T 4"], signs: Int[np.ndarray, "V"], points: Int[np.ndarray, "V 3"], node: _Nodes
) -> list[Int[np.ndarray, "N 4"]]:
    """What lies on the negative side of tets of both signs."""
    sign = signs[tets]
    order = np.argsort(sign, axis=1, kind="stable")
    sorted_tets, negative, zero = (
        np.take_along_axis(tets, order, axis=1),
        (sign < 0).sum(1),
        (sign == 0).sum(1),
    )

    def corners(negatives: int, zeros: int) -> Int[np.ndarray, "4 N"]:
        return sorted_tets[(negative == negatives) & (zero == zeros)].T

    pieces = []
    a, b, c, d = corners(1, 0)
    pieces.append([a, node(a, b), node(a, c), node(a, d)])
    a, b, c, d = corners(1, 1)
    pieces.append([a, b, node(a, c), node(a, d)])
    a, b, c, d = corners(1, 2)
    pieces.append([a, b, c, node(a, d)])
    a, b, c, d = corners(2, 1)
    a, b = _swap(a, b, ~_starts(a, b, d, points))
    pieces += [[a, b, c, node(b, d)], [a, node(b, d), c, node(a, d)]]
    a, b, c, d = corners(2, 0)  # a prism over a triangle at either end of ab
    a, b = _swap(a, b, ~_starts(a, b, c, points))  # then the other quadrilateral's diagonal starts at b
    ac, ad, bc, bd = node(a, c), node(a, d), node(b, c), node(b, d)
    pieces += [[a, b, bc, ad], [b, bd, bc, ad], [a, bc, ac, ad]]
    a, b, c, d = corners(3, 0)  # a prism over abc
    for first, second in ((0, 1), (1, 2), (0, 1)):  # sorted by where the diagonals start
        abc = [a, b, c]
        abc[first], abc[second] = _swap(abc[first], abc[second], ~_starts(abc[first], abc[second], d, points))
        a, b, c = abc
    ad, bd, cd = node(a, d), node(b, d), node(c, d)
    pieces += [[a, b, c, cd], [a, b, bd, cd], [a, ad, bd, cd]]
    return [np.stack(piece, axis=1) for piece in pieces]


def _swap(
    a: Int[np.ndarray, "N"], b: Int[np.ndarray, "N"], swapped: Bool[np.ndarray, "N"]
) -> tuple[Int[np.ndarray, "N"], Int[np.ndarray, "N"]]:
    return np.where(swapped, b, a), np.where(swapped, a, b)


def _starts(
    a: Int[np.ndarray, "N"], b: Int[np.ndarray, "N"], c: Int[np.ndarray, "N"], points: Int[np.ndarray, "V 3"]
) -> Bool[np.ndarray, "N"]:
    """Whether the diagonal of the quadrilateral on ab, in the face abc, starts at a and not at b."""
    odd, halves = points[:, 0] % 2, _halves(points)
    return np.where(odd[a] == odd[b], halves[a] == halves[c], odd[a] == odd[c])


def _halves(points: Int[np.ndarray, "V 3"]) -> Int[np.ndarray, "V"]:
    """0 or 1 in turns for the corners along each axis, and for the centres."""
    return points.sum(axis=1) // 2 % 2
