"""Hierarchies of grids, made by 1-to-8 subdivision."""

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

from tetgan.errors import UserError
from tetgan.geometry.adjacency import unique_edges
from tetgan.grids.grid import TetGrid
from tetgan.grids.lattice import Lattice, cube_lattice
from tetgan.grids.options import GridOptions
from tetgan.grids.subdivision import CHILDREN, shortest_diagonal
from tetgan.grids.tetfile import read_tet

# Grids read from files are snapped to multiples of 1/630,000: coarser than the single-precision noise of
# `.tet` files (0.8 is 0.8000001 there), so equal lengths compare equal, and exact for decimals of four
# places and for lattices of up to ten cells.
_SNAP = 630_000


@dataclass(frozen=True, eq=False)
class GridHierarchy:
    """Grids from coarse to fine; the children of tet i of a level are tets 8i..8i+7 of the next."""

    levels: tuple[TetGrid, ...]

    @property
    def coarsest(self) -> TetGrid:
        return self.levels[0]

    @property
    def finest(self) -> TetGrid:
        return self.levels[-1]

    @property
    def depth(self) -> int:
        """Number of subdivisions: one less than the number of levels."""
        return len(self.levels) - 1

    @cached_property
    def digest(self) -> str:
        """SHA-256 over the digests of all levels, hexadecimal."""
        return hashlib.sha256("".join(grid.digest for grid in self.levels).encode()).hexdigest()


def build_hierarchy(cells: int, depth: int) -> GridHierarchy:
    """The cube lattice of `cells` cells a side, subdivided `depth` times."""
    return subdivide_lattice(cube_lattice(cells), depth)


def subdivide_lattice(base: Lattice, depth: int) -> GridHierarchy:
    """A lattice subdivided `depth` times."""
    return _subdivide(base.points, base.tets, base.unit, depth)


def subdivide_hierarchy(base: TetGrid, depth: int) -> GridHierarchy:
    """Any grid of the unit cube, subdivided `depth` times.

    Vertices are first snapped to multiples of 1/630,000, so that equal lengths compare equal; that moves
    none by more than 8e-7, and none at all of a lattice of up to ten cells.

    Raises:
        ValueError: a vertex lies outside the unit cube.
    """
    points = np.rint(base.vertices * _SNAP).astype(np.int64)
    if points.min(initial=0) < 0 or points.max(initial=0) > _SNAP:
        raise ValueError("the grid reaches outside the unit cube")
    return _subdivide(points, base.tets, _SNAP, depth)


def upsampling_weights(coarse: TetGrid, fine: TetGrid) -> Float[np.ndarray, "T 8 5"]:
    """Weights of the paper's upsampling: inverse distances between centroids, each child's summing to 1.

    As in the official code, the parent itself counts among its neighbours; the paper's text leaves it out.

    Returns:
        (T_coarse, 8, 5) for each parent and child: the parent, then its neighbours in slot order; 0 where
        there is no neighbour.
    """
    children = fine.centroids.reshape(-1, 8, 1, 3)
    sources = np.concatenate([np.arange(len(coarse.tets))[:, None], coarse.neighbors], axis=1)
    distances = np.linalg.norm(coarse.centroids[sources][:, None] - children, axis=-1)
    weights = (sources >= 0)[:, None] / distances
    return weights / weights.sum(axis=-1, keepdims=True)


def _subdivide(
    points: Int[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"], unit: int, depth: int
) -> GridHierarchy:
    """Levels from vertices given as integers in units of 1/`unit`; each level halves the unit."""
    levels = [TetGrid(points / unit, tets)]
    for _ in range(depth):
        points, tets = _subdivide_once(points, tets)
        unit *= 2
        levels.append(TetGrid(points / unit, tets))
    return GridHierarchy(tuple(levels))


def _subdivide_once(
    points: Int[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]
) -> tuple[Int[np.ndarray, "W 3"], Int[np.ndarray, "S 4"]]:
    """Eight tets in place of each, on vertices in units half as large: the old ones, then the midpoints."""
    edges, edge_of_side = unique_edges(tets)
    finer = np.concatenate([2 * points, points[edges].sum(axis=1)])
    local = np.concatenate([tets, edge_of_side + len(points)], axis=1)
    children = CHILDREN[shortest_diagonal(points[tets], tets)]
    return finer, np.take_along_axis(local[:, None], children, axis=2).reshape(-1, 4)


def grid_from_options(options: GridOptions) -> GridHierarchy:
    """The hierarchy that `options` describe.

    Raises:
        UserError: the `.tet` file is missing, malformed or reaches outside the unit cube.
    """
    if options.cells is not None:
        return build_hierarchy(options.cells, options.depth)
    assert options.file is not None  # the options hold exactly one of the two
    try:
        return subdivide_hierarchy(read_tet(options.file), options.depth)
    except ValueError as error:
        raise UserError(f"{options.file}: {error}; scale it to fit") from None
