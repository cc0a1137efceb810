"""Green closure: tets some of whose edges are split, cut so that they meet their finer neighbours.

A face has no edge split, one or all three: with two, its tets could cut it in different ways. So the split
edges of a tet join its corners in groups that are split throughout: two corners (the tet is cut in 2), twice
two (in 4), three (in 4), or all four, where it is subdivided instead. The tet is the join of its groups, and
its pieces are all joins of the parts of one group with those of the other.

In a lattice the pieces of whole tets have no dihedral angle below 30 degrees, those of the half tets at the
wall of a cube none below 13.8.
"""

from itertools import combinations, product

import numpy as np
from jaxtyping import Bool, Int

from tetgan.geometry.adjacency import EDGES

ALL_SPLIT = 63


def edge_pattern(split: Bool[np.ndarray, "T 6"]) -> Int[np.ndarray, "T"]:
    """One number of six bits for which of `EDGES` are split, with those added that groups need."""
    return _CLOSED[split @ (1 << np.arange(6))]


def pattern_edges(patterns: Int[np.ndarray, "T"]) -> Bool[np.ndarray, "T 6"]:
    """Edges that a pattern splits."""
    return (patterns[:, None] >> np.arange(6) & 1).astype(bool)


def _midpoint(one: int, other: int) -> int:
    """Local vertex in the middle of an edge: 4-9 for `EDGES`."""
    return 4 + EDGES.tolist().index(sorted((one, other)))


def _groups(pattern: int) -> list[list[int]]:
    """Corners joined by split edges; a corner without any is a group of its own."""
    groups = [{corner} for corner in range(4)]
    for k, (one, other) in enumerate(EDGES.tolist()):
        if pattern >> k & 1:
            joined = [group for group in groups if one in group or other in group]
            groups = [group for group in groups if group not in joined] + [set.union(*joined)]
    return [sorted(group) for group in groups]


def _closed(pattern: int) -> int:
    pairs = [pair for group in _groups(pattern) for pair in combinations(group, 2)]
    return sum(1 << _midpoint(*pair) - 4 for pair in pairs)


def _parts(group: list[int]) -> list[dict[int, int]]:
    """Local vertices in place of the corners of a group, in each of the parts it is cut into."""
    parts = [{a: a if a == corner else _midpoint(a, corner) for a in group} for corner in group]
    if len(group) == 3:
        a, b, c = group
        parts.append({a: _midpoint(b, c), b: _midpoint(c, a), c: _midpoint(a, b)})
    return parts


def _pieces(pattern: int) -> Int[np.ndarray, "P 4"]:
    """Tets in local vertices: corners 0-3, then the midpoints of `EDGES`."""
    joins = product(*map(_parts, _groups(pattern)))
    places = [{corner: vertex for part in join for corner, vertex in part.items()} for join in joins]
    return np.array([[place[corner] for corner in range(4)] for place in places])


_CLOSED = np.array([_closed(pattern) for pattern in range(64)])

# The patterns that a leaf may have, 0 for a whole one; every piece is positive where the tet is.
PIECES = {pattern: _pieces(pattern) for pattern in sorted({*_CLOSED.tolist()} - {ALL_SPLIT})}
