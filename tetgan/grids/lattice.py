"""Body-centred cubic lattices: one fills the unit cube exactly, a pure one reaches beyond it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Int

from tetgan.grids.grid import TetGrid

# Corners of a unit square in turning order, as offsets along the two axes that follow the face's normal.
_RING = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])


@dataclass(frozen=True, eq=False)
class Lattice:
    """Tets of cells, on points that are integers in units of half a cell.

    Each edge of a cell face is joined to the two sides of the face: to the centres of the cells there.

    Attributes:
        points: (V, 3) int64, in lexicographic order.
        tets: (T, 4) int64, positive.
        unit: side of the unit cube, whose lower corner is the origin.
        longest_edge: a bound for all edges that holds again, in halved units, after each subdivision.
    """

    points: Int[np.ndarray, "V 3"]
    tets: Int[np.ndarray, "T 4"]
    unit: int
    longest_edge: float

    @cached_property
    def grid(self) -> TetGrid:
        """The same tets in the coordinates of the unit cube."""
        return TetGrid(self.points / self.unit, self.tets)


def cube_lattice(cells: int) -> Lattice:
    """The unit cube cut into cells³ cells: 12·cells²·(cells + 1) tets that fill it.

    At the wall of the cube the face's own centre is its outer side, so no corner of the cube is cut. The
    half tets there are of another shape than the rest, and refine into worse ones.
    """
    corners = _face_tets(range(cells + 1), range(cells))
    # A centre beyond the wall is pulled back onto it, where it is the centre of the face.
    return _lattice(corners.clip(0, 2 * cells), 2 * cells, longest_edge=np.sqrt(5))


def open_lattice(cells: int, margin: int = 1) -> Lattice:
    """Whole tets alone, on the cells of the unit cube and `margin` more on every side, at least one.

    They are those around the faces between two cells, so they cover the unit cube and end in a jagged hull.
    All have the shape with squared edges 3 3 3 3 4 4 and dihedral angles of 60 and 90 degrees, and so have
    all that they are subdivided into.
    """
    low, high = -margin, cells + margin
    corners = _face_tets(range(low + 1, high), range(low, high))
    return _lattice(corners, 2 * cells, longest_edge=2.0)


def _lattice(corners: Int[np.ndarray, "T 4 3"], unit: int, longest_edge: float) -> Lattice:
    """Number the vertices of tets in the order of their coordinates."""
    low = corners.min(axis=(0, 1))
    base = int((corners - low).max()) + 1
    keys, inverse = np.unique((corners - low) @ np.array([base**2, base, 1]), return_inverse=True)
    points = np.stack([keys // base**2, keys // base % base, keys % base], axis=1) + low
    return Lattice(points, inverse.reshape(-1, 4), unit, float(longest_edge))


def _face_tets(along: range, across: range) -> Int[np.ndarray, "T 4 3"]:
    """Corners of the four tets around cell faces, for the three axes in turn.

    Args:
        along: places of the faces on the axis of their normal.
        across: places of the faces on the other two axes.
    """
    face = np.stack(np.meshgrid(along, across, across, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    ring = np.insert(_RING, 0, 0, axis=1)
    start, end = 2 * (face + ring), 2 * (face + np.roll(ring, -1, axis=0))
    below, above = (np.broadcast_to(2 * face + (side, 1, 1), start.shape) for side in (-1, 1))
    tets = np.stack([below, start, end, above], axis=2).reshape(-1, 4, 3)
    # A cyclic change of axes keeps the orientation.
    return np.concatenate([np.roll(tets, axis, axis=-1) for axis in range(3)])
