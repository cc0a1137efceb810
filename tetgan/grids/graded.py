"""Graded grids: a lattice subdivided only where it is asked to be, closed so that tets share whole faces.

Tets whose edges are split by finer neighbours are cut in 2 or 4, the "green" closure (Bank et al. 1983, for
tets Bey 1995). Their pieces are never subdivided, so tets that share an edge differ by one level at most.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.adjacency import EDGES
from tetgan.grids.closure import ALL_SPLIT, PIECES, edge_pattern, pattern_edges
from tetgan.grids.grid import TetGrid
from tetgan.grids.lattice import Lattice
from tetgan.grids.subdivision import CHILDREN, CORNER_TETS, midpoint_order, shortest_diagonal

# Asked once a level, with its number and the corners in the unit cube of the tets that may be subdivided:
# all of the lattice at level 0, then the children of those chosen before, eight of each in a row.
Choice = Callable[[int, Float[np.ndarray, "N 4 3"]], Bool[np.ndarray, "N"]]

# Edges of a tet's children that lie on its own edges and faces, in the local vertices of `CORNER_TETS`.
_OUTER_EDGES = CORNER_TETS[:, EDGES].reshape(-1, 2)


@dataclass(frozen=True, eq=False)
class GradedGrid(TetGrid):
    """Tets that share faces, of several sizes.

    Attributes:
        points: (V, 3) the vertices in units of half a cell of the finest level. In an open lattice each is a
            corner of such a cell, even in all coordinates, or a centre, odd in all.
        level: (T,) number of subdivisions that made the tet, or the tet that it is a piece of.
        green: (T,) pieces of tets with finer neighbours; none is of the finest level.
    """

    points: Int[np.ndarray, "V 3"]
    level: Int[np.ndarray, "T"]
    green: Bool[np.ndarray, "T"]


def graded_grid(base: Lattice, depth: int, choose: Choice) -> GradedGrid:
    """A lattice subdivided up to `depth` times where `choose` says so.

    Tets that touch chosen ones are subdivided as well where closing the mesh needs it. With everything chosen
    the tets are those of `subdivide_lattice(base, depth).finest` in the same order, and only the numbering of
    the vertices differs: here it follows their coordinates.

    Tets of the finest level come last: the children of those chosen last, eight of each in a row, then what
    closing the mesh adds.
    """
    forest = _Forest(base, depth)
    for number in range(depth):
        level = forest.levels[number]
        forest.subdivide(number, choose(number, forest.points(level.keys) / forest.unit))
    forest.balance()
    keys, level, green = zip(*forest.leaves(), strict=True)
    corners, inverse = np.unique(np.concatenate(keys), return_inverse=True)
    points = forest.points(corners)
    sizes = [len(part) for part in keys]
    return GradedGrid(
        vertices=points / forest.unit,
        tets=inverse.reshape(-1, 4),
        points=points,
        level=np.repeat(level, sizes),
        green=np.repeat(green, sizes),
    )


@dataclass(eq=False)
class _Level:
    """Tets of one size.

    Attributes:
        keys: (N, 4) vertices; see `_Forest`.
        order: (N, 4) place of each vertex among the four, in the order of the vertices of `build_hierarchy`.
        is_split: (N,) tets that are subdivided; the others are leaves.
        pattern: (N,) edges that are split, for `PIECES`.
    """

    keys: Int[np.ndarray, "N 4"]
    order: Int[np.ndarray, "N 4"]
    is_split: Bool[np.ndarray, "N"]
    pattern: Int[np.ndarray, "N"]

    @classmethod
    def of(cls, keys: Int[np.ndarray, "N 4"], order: Int[np.ndarray, "N 4"]) -> "_Level":
        return cls(keys, order, np.zeros(len(keys), dtype=bool), np.zeros(len(keys), dtype=np.int64))

    def extend(self, other: "_Level") -> None:
        for name in ("keys", "order", "is_split", "pattern"):
            setattr(self, name, np.concatenate([getattr(self, name), getattr(other, name)]))


class _Forest:
    """Tets of all levels, each of which has eight children in the next or is a leaf.

    A vertex is known by its key: its integer coordinates, in units of half a cell of the finest level and
    counted from the lowest, as one number of three digits. The key of a midpoint is the mean of two, and an
    edge is known by the key of its midpoint.
    """

    def __init__(self, base: Lattice, depth: int) -> None:
        self.unit = base.unit * 2**depth
        points = base.points * 2**depth
        self._low = points.min(axis=0)
        self._base = int((points - self._low).max()) + 1
        keys = (points - self._low) @ np.array([self._base**2, self._base, 1])
        empty = np.empty((0, 4), dtype=np.int64)
        self.levels = [_Level.of(keys[base.tets], base.tets)] + [
            _Level.of(empty, empty) for _ in range(depth)
        ]

    def points(self, keys: Int[np.ndarray, "*N"]) -> Int[np.ndarray, "*N 3"]:
        """Integer coordinates of vertices."""
        rest, z = np.divmod(keys, self._base)
        return np.stack([*np.divmod(rest, self._base), z], axis=-1) + self._low

    def subdivide(self, number: int, chosen: Bool[np.ndarray, "N"]) -> None:
        """Append the children of the `chosen` leaves of a level to the next."""
        level = self.levels[number]
        level.is_split |= chosen
        keys, order = level.keys[chosen], level.order[chosen]
        children = CHILDREN[shortest_diagonal(self.points(keys), order)].reshape(-1, 32)
        # Old vertices come before midpoints, as they do in `build_hierarchy`.
        base = int(order.max(initial=0)) + 1
        places = np.concatenate([order, base + midpoint_order(order, base)], axis=1)
        places = np.take_along_axis(places, children, axis=1).reshape(-1, 4)
        self.levels[number + 1].extend(
            _Level.of(
                np.take_along_axis(_with_midpoints(keys), children, axis=1).reshape(-1, 4),
                places.argsort(axis=1).argsort(axis=1),
            )
        )

    def balance(self) -> None:
        """Subdivide leaves until green patterns close all of them."""
        count = -1
        # Nothing depends on the finest tets: they stay whole.
        while count != (count := sum(len(level.keys) for level in self.levels[:-1])):
            finer = np.empty(0, dtype=np.int64)
            for number in reversed(range(len(self.levels) - 1)):
                finer = self._close(number, finer)

    def _close(self, number: int, finer: Int[np.ndarray, "F"]) -> Int[np.ndarray, "E"]:
        """Close one level, given the split edges of the next finer one.

        A leaf is subdivided where an edge of its children would be split, or where its pattern has all edges.

        Returns:
            Split edges of this level.
        """
        level = self.levels[number]
        edges, sides = np.unique(_with_midpoints(level.keys)[:, 4:], return_inverse=True)
        sides = sides.reshape(-1, 6)
        is_split = np.zeros(len(edges), dtype=bool)
        is_split[sides[level.is_split]] = True
        touched = np.flatnonzero(is_split[sides].any(axis=1) & ~level.is_split)
        halves = _with_midpoints(level.keys[touched])[:, _OUTER_EDGES].sum(axis=2) // 2
        is_split[sides[touched[np.isin(halves, finer).any(axis=1)]]] = True
        count = -1
        while count != (count := int(is_split.sum())):
            level.pattern = edge_pattern(is_split[sides])
            is_split[sides[pattern_edges(level.pattern)]] = True
        self.subdivide(number, (level.pattern == ALL_SPLIT) & ~level.is_split)
        return edges[is_split]

    def leaves(self) -> Iterator[tuple[Int[np.ndarray, "N 4"], int, bool]]:
        """Vertices of tets, whole leaves and pieces, with their level and whether they are green."""
        for number, level in enumerate(self.levels):
            for pattern, pieces in PIECES.items():
                keys = level.keys[~level.is_split & (level.pattern == pattern)]
                local = _with_midpoints(keys) if pattern else keys
                yield local[:, pieces].reshape(-1, 4), number, pattern != 0


def _with_midpoints(keys: Int[np.ndarray, "N 4"]) -> Int[np.ndarray, "N 10"]:
    """Corners and midpoints of `EDGES`."""
    return np.concatenate([keys, keys[:, EDGES].sum(axis=2) // 2], axis=1)
