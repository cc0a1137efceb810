"""A body-centred cubic lattice that fills the unit cube exactly."""

import numpy as np
from jaxtyping import Int

from tetgan.grids.grid import TetGrid

# Corners of a unit square in turning order, as offsets along the two axes that follow the face's normal.
_RING = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])

# Of the lattice however often subdivided, in sides of a cell of that level. Off the wall the longest edge is
# such a side; the half cells at the wall have longer ones after the first subdivision.
LONGEST_EDGE = np.sqrt(5) / 2


def cube_lattice(cells: int) -> TetGrid:
    """The unit cube cut into cells³ cells, each edge of each cell face joined to the two sides of the face.

    A side is the centre of the cell there or, at the wall of the cube, the centre of the face itself, so
    the grid has 12·cells²·(cells + 1) tets and no corner of the cube is cut.
    """
    points, tets = lattice_points(cells)
    return TetGrid(points / (2 * cells), tets)


def lattice_points(cells: int) -> tuple[Int[np.ndarray, "V 3"], Int[np.ndarray, "T 4"]]:
    """The lattice with its vertices as integers in units of half a cell; see `cube_lattice`."""
    corners = np.concatenate([_axis_tets(cells, axis) for axis in range(3)])
    base = 2 * cells + 1
    keys, inverse = np.unique(corners @ np.array([base**2, base, 1]), return_inverse=True)
    points = np.stack([keys // base**2, keys // base % base, keys % base], axis=1)
    return points, inverse.reshape(-1, 4)


def _axis_tets(cells: int, axis: int) -> Int[np.ndarray, "T 4 3"]:
    """Integer corners of the tets around every cell face whose normal is `axis`."""
    face = np.stack(np.meshgrid(*[np.arange(cells + 1)] + [np.arange(cells)] * 2, indexing="ij"), axis=-1)
    face = face.reshape(-1, 1, 3)
    ring = np.insert(_RING, 0, 0, axis=1)
    start, end = 2 * (face + ring), 2 * (face + np.roll(ring, -1, axis=0))
    # A centre beyond the wall is pulled back onto it, where it is the centre of the face.
    below, above = (
        np.broadcast_to(np.clip(2 * face + (side, 1, 1), 0, 2 * cells), start.shape) for side in (-1, 1)
    )
    tets = np.stack([below, start, end, above], axis=2).reshape(-1, 4, 3)
    return np.roll(tets, axis, axis=-1)  # a cyclic change of axes keeps the orientation
