"""1-to-8 subdivision of tets: the table of children, and the diagonal that splits the octahedron."""

from itertools import pairwise

import numpy as np
from jaxtyping import Int, Integer

from tetgan.geometry.adjacency import EDGES

# Local vertices of a tet whose edges are cut: corners 0-3, then the midpoints of 01 02 03 12 13 23.
CORNER_TETS = np.array([[0, 4, 5, 6], [4, 1, 7, 8], [5, 7, 2, 9], [6, 8, 9, 3]])

# The corner tets leave an octahedron: its diagonals, each with the four midpoints that turn around it.
_DIAGONALS = [(4, 9), (5, 8), (6, 7)]
_RINGS = [(5, 6, 8, 7), (4, 7, 9, 6), (4, 5, 9, 8)]

# (diagonal, child, local vertex)
CHILDREN = np.array(
    [
        [*CORNER_TETS.tolist(), *([*ends, *side] for side in pairwise([*ring, ring[0]]))]
        for ends, ring in zip(_DIAGONALS, _RINGS, strict=True)
    ]
)


def shortest_diagonal(
    corners: Integer[np.ndarray, "T 4 3"], order: Integer[np.ndarray, "T 4"]
) -> Int[np.ndarray, "T"]:
    """Which of the three diagonals splits each octahedron.

    Lengths are exact integers. Ties are common, and go to the diagonal that has the first midpoint, a rule
    that does not see the order of a tet's own vertices. Midpoints of edges come in the order of their edges:
    by the earlier corner, then by the later one.

    Args:
        corners: coordinates of the four vertices.
        order: place of each vertex among those of the grid, or among the four.
    """
    # A diagonal joins the midpoints of two opposite edges, which are edge k and edge 5 - k.
    midpoints = corners[:, EDGES].sum(axis=2)
    lengths = ((midpoints[:, :3] - midpoints[:, :2:-1]) ** 2).sum(axis=-1)
    places = midpoint_order(order, int(order.max(initial=0)) + 1)
    first = np.minimum(places[:, :3], places[:, :2:-1])
    shortest = lengths == lengths.min(axis=1, keepdims=True)
    return np.where(shortest, first, np.iinfo(first.dtype).max).argmin(axis=1)


def midpoint_order(order: Integer[np.ndarray, "T 4"], base: int) -> Int[np.ndarray, "T 6"]:
    """Numbers that put the midpoints of `EDGES` in order, from those of the corners, all below `base`."""
    ends = np.sort(order[:, EDGES].astype(np.int64), axis=-1)
    return ends[..., 0] * base + ends[..., 1]
