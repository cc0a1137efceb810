"""Active sets: the tets of a hierarchy near a surface, level by level, and batches of several."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Int, Int8, Int32

from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import GridHierarchy

CHILDREN = 8


@dataclass(frozen=True, eq=False)
class ActiveLevel:
    """The active tets of one level.

    Attributes:
        cells: (N,) their numbers in the grid of the level; eight children in a row.
        neighbors: (N, 4) places of their neighbours among them, slot by slot; -1 where none is active.
        back: (N, 4) the slot in which that neighbour has this tet; 0 where there is none.
        split: (N,) whether the children are active; they are the tets of the next level, in the same order.
    """

    cells: Int32[np.ndarray, "N"]
    neighbors: Int32[np.ndarray, "N 4"]
    back: Int8[np.ndarray, "N 4"]
    split: Bool[np.ndarray, "N"]

    @property
    def parents(self) -> Int32[np.ndarray, "P"]:
        """Places of the tets that are split."""
        return np.flatnonzero(self.split).astype(np.int32)


class Adjacency(NamedTuple):
    """Who is across each face of the tets of a grid, -1 beyond the wall, and in which of its slots."""

    neighbors: Int32[np.ndarray, "T 4"]
    back: Int8[np.ndarray, "T 4"]


def adjacency(grid: TetGrid) -> Adjacency:
    """The neighbours of a grid's tets, and the slots that lead back."""
    neighbors = grid.neighbors.astype(np.int32)
    there = neighbors[neighbors]  # of a missing neighbour some row, which is not looked at
    back = (there == np.arange(len(neighbors))[:, None, None]).argmax(axis=2)
    return Adjacency(neighbors, np.where(neighbors < 0, 0, back).astype(np.int8))


def adjacencies(hierarchy: GridHierarchy) -> list[Adjacency]:
    """Of every level, coarse to fine; made once for many active sets."""
    return [adjacency(grid) for grid in hierarchy.levels]


def active_levels(around: Sequence[Adjacency], near: Bool[np.ndarray, "T"]) -> list[ActiveLevel]:
    """The active set of a shape, coarse to fine: all coarsest tets, then children of those that are split.

    A tet is split if a finest tet inside it is `near`, so every finest tet that is near is active.

    Args:
        around: `adjacencies` of the hierarchy.
        near: of the finest tets, whether they must be active.
    """
    wanted: list[Any] = [near]
    for _ in around[1:]:
        wanted.insert(0, wanted[0].reshape(-1, CHILDREN).any(axis=1))
    # At the finest level nothing is split.
    wanted[-1] = np.zeros_like(near)
    levels, cells = [], np.arange(len(around[0].neighbors), dtype=np.int32)
    for adjacent, split in zip(around, wanted, strict=True):
        neighbors, back = tables_among(adjacent, cells)
        levels.append(ActiveLevel(cells, neighbors, back, split[cells]))
        cells = children_of(cells[split[cells]])
    return levels


def children_of(cells: Int[np.ndarray, "P"]) -> Int[np.ndarray, "8*P"]:
    """The children of some tets, eight in a row."""
    return (cells[:, None] * CHILDREN + np.arange(CHILDREN, dtype=cells.dtype)).ravel()


def tables_among(
    around: Adjacency, cells: Int[np.ndarray, "N"]
) -> tuple[Int32[np.ndarray, "N 4"], Int8[np.ndarray, "N 4"]]:
    """Neighbours of some tets among themselves, by place, and slots that lead back; see `ActiveLevel`.

    Tets of several shapes, numbered on from shape to shape, go together: no shape touches another.
    """
    tets = len(around.neighbors)
    shape, cell = np.divmod(cells, tets)
    place = np.full((int(shape[-1]) + 1 if len(shape) else 1, tets + 1), -1, dtype=np.int32)
    place[shape, cell] = np.arange(len(cells), dtype=np.int32)
    neighbors = place[shape[:, None], around.neighbors[cell]]  # the -1 of the wall reads the last column
    return neighbors, np.where(neighbors < 0, np.int8(0), around.back[cell])
