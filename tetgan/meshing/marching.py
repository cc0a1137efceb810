"""Marching cubes of functions of space, densely or by an octree (MISE)."""

from collections.abc import Callable

import igl
import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.triangles import TriangleMesh

Value = Callable[[Float[np.ndarray, "N 3"]], Float[np.ndarray, "N"]]

Cube = Float[np.ndarray, "R R R"]


# Corners of a cell in the order that libigl wants: around the bottom, then around the top.
_CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])


def mise(value: Value, start: int, steps: int, level: float, *, box: float = 1.0) -> TriangleMesh:
    """Surface where `value` crosses `level`, by an octree (MISE, Mescheder et al. 2019, sec. 3.3).

    All points of a coarse grid are evaluated, then the grid is halved `steps` times; new points are evaluated
    only in cells that the surface enters, and in their neighbours as soon as it is seen to leave through
    their faces. The surface is that of evaluating every point of the finest grid, except for parts that no
    coarser grid has a point on either side of. Beyond the box everything is outside, so surfaces close, up
    to half a cell beyond it.

    Args:
        value: above `level` inside; positions in the unit cube.
        start: cells along a side of the coarsest grid.
        steps: halvings; 0 evaluates every point.
        box: side of the cube that is searched, about the centre of the unit cube.

    Returns:
        Faces outward; none where nothing is above the level.
    """
    values = _evaluate(value, np.ones(3 * (start + 1,), dtype=bool), box)
    values, known = values.reshape(3 * (start + 1,)), np.ones(3 * (start + 1,), dtype=bool)
    for _ in range(steps):
        values, known = _refine(value, values, known, level, box)
    spacing = box / (len(values) - 1)
    return _march(values, level, origin=0.5 - box / 2, spacing=spacing)


def voxel_surface(distance: Cube, level: float = 0.0) -> TriangleMesh:
    """Surface on which signed distances at cell centres, negative inside, cross `level`.

    A shape that reaches the wall of the cube is closed there.
    """
    spacing = 1 / len(distance)
    return _march(-distance, -level, origin=spacing / 2, spacing=spacing)


def _refine(
    value: Value, coarse: Cube, known: Bool[np.ndarray, "R R R"], level: float, box: float
) -> tuple[Float[np.ndarray, "S S S"], Bool[np.ndarray, "S S S"]]:
    """Twice as many cells along a side: evaluated where the surface is, interpolated elsewhere.

    What is interpolated lies on the right side of the level, for it lies in cells with all corners on one.
    """
    values = _halve_cells(coarse)
    evaluated = np.zeros(values.shape, dtype=bool)
    evaluated[::2, ::2, ::2] = known
    while True:
        inside = values > level
        entered = _any_of_cell(inside) & _any_of_cell(~inside)
        wanted = _points_of_cells(entered) & ~evaluated
        if not wanted.any():
            return values, evaluated
        values[wanted] = _evaluate(value, wanted, box)
        evaluated |= wanted


def _evaluate(value: Value, wanted: Bool[np.ndarray, "R R R"], box: float) -> Float[np.ndarray, "N"]:
    """Values at some points of a grid, in the order of its indices."""
    places = np.argwhere(wanted) / (len(wanted) - 1)
    return np.asarray(value(0.5 + box * (places - 0.5)), dtype=np.float32)


def _halve_cells(values: Cube) -> Float[np.ndarray, "S S S"]:
    """Points halfway between neighbours, linearly interpolated along each axis in turn."""
    for axis in range(3):
        ends = np.moveaxis(values, axis, 0)
        both = np.empty((2 * len(ends) - 1, *ends.shape[1:]), dtype=values.dtype)
        both[::2] = ends
        both[1::2] = (ends[:-1] + ends[1:]) / 2
        values = np.moveaxis(both, 0, axis)
    return np.ascontiguousarray(values)


def _any_of_cell(flags: Bool[np.ndarray, "S S S"]) -> Bool[np.ndarray, "C C C"]:
    """Whether any of the 27 points of each coarse cell is flagged."""
    for axis in range(3):
        line = np.moveaxis(flags, axis, 0)
        flags = np.moveaxis(line[:-1:2] | line[1::2] | line[2::2], 0, axis)
    return flags


def _points_of_cells(cells: Bool[np.ndarray, "C C C"]) -> Bool[np.ndarray, "S S S"]:
    """The points, 27 each, of flagged coarse cells."""
    for axis in range(3):
        line = np.moveaxis(cells, axis, 0)
        points = np.zeros((2 * len(line) + 1, *line.shape[1:]), dtype=bool)
        points[1::2] = line
        points[:-1:2] |= line
        points[2::2] |= line
        cells = np.moveaxis(points, 0, axis)
    return cells


def _march(values: Cube, level: float, *, origin: float, spacing: float) -> TriangleMesh:
    """Marching cubes of values above the level inside, closed at the wall.

    Around the grid lies one more layer of points, outside: the values at the wall mirrored in the level.
    """
    mirrored = np.pad(values, 1, mode="edge")
    padded = np.minimum(mirrored, 2 * level - mirrored)
    padded[1:-1, 1:-1, 1:-1] = values
    cells = _crossed_cells(padded > level)
    if len(cells) == 0:
        return TriangleMesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))
    corners = np.ravel_multi_index(tuple(np.moveaxis(cells[:, None] + _CORNERS, 2, 0)), padded.shape)
    used, compact = np.unique(corners, return_inverse=True)
    places = origin + spacing * (np.stack(np.unravel_index(used, padded.shape), axis=1) - 1.0)
    above = padded.ravel()[used].astype(np.float64) - level
    vertices, faces, _ = igl.marching_cubes(above, places, compact.reshape(-1, 8), 0.0)
    return TriangleMesh(vertices, faces[:, ::-1].astype(np.int64))


def _crossed_cells(inside: Bool[np.ndarray, "R R R"]) -> Int[np.ndarray, "C 3"]:
    """Cells with corners on both sides."""
    some, every = inside, inside
    for axis in range(3):
        first, last = (np.moveaxis(flags, axis, 0) for flags in (some, every))
        some = np.moveaxis(first[:-1] | first[1:], 0, axis)
        every = np.moveaxis(last[:-1] & last[1:], 0, axis)
    return np.argwhere(some & ~every)
