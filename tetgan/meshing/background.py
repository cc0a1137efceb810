"""The lattice that a solid is cut from: fine where its surface is, and a signed distance at its vertices."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import distance_transform_edt

from tetgan.grids.graded import GradedGrid, graded_grid
from tetgan.grids.lattice import open_lattice
from tetgan.grids.options import Interior
from tetgan.meshing.isosurface import around_crossings
from tetgan.meshing.planes import Planes

_REACH = 3.0  # cells around the surface that are fine: it crosses edges of one, and two rings make way for it

_MARGIN = 4  # cells around the cube, at least, that the lattice has

_DEEPEST = 4  # times that a coarse lattice is subdivided


def lattice_around(
    planes: Planes, changes: Float[np.ndarray, "C 3"], cells: int, interior: Interior
) -> tuple[GradedGrid, Float[np.ndarray, "V"]]:
    """A body-centred cubic lattice beyond the cube on all sides, and the distance at its vertices.

    Near the surface the distance is that of the planes; elsewhere all that counts is on which side a vertex
    lies. Where the planes change sides and nobody expected a surface, as noise does, the lattice is made
    fine there too.

    Args:
        changes: further points that the surface may pass.
        cells: of the finest level along a side of the unit cube.
        interior: 'fine', or coarser the further from the surface.

    Returns:
        The lattice and the distance, nowhere zero and positive on the hull.
    """
    depth = subdivisions(cells)
    cell = 1 / cells
    near = [planes.feet[np.abs(planes.distances) < 2 * _REACH * cell], changes]
    while True:
        reached = _Reached(np.concatenate(near), cells)

        def choose(
            level: int, corners: Float[np.ndarray, "N 4 3"], reached: _Reached = reached
        ) -> Bool[np.ndarray, "N"]:
            centroids = corners.mean(axis=1)
            radius = np.sqrt(((corners - centroids[:, None]) ** 2).sum(axis=2).max(axis=1))
            chosen = reached.within(centroids, radius + _REACH * cell)
            if interior == "fine":
                chosen[~chosen] = planes.inside(centroids[~chosen])
            return chosen

        grid = graded_grid(open_lattice(cells >> depth, _margin(depth)), depth, choose)
        fine = (grid.level == depth) & ~grid.green
        distances = _distances(grid, fine, planes, reached, cell)
        unexpected = around_crossings(grid.tets, distances)[1] & ~fine
        if not unexpected.any():
            return grid, distances
        near.append(grid.centroids[unexpected])


class _Reached:
    """How far cells of the lattice are from the nearest that a point lies in: an EDT in place of a search."""

    def __init__(self, points: Float[np.ndarray, "P 3"], cells: int) -> None:
        depth = subdivisions(cells)
        self._cells, self._margin = cells, _margin(depth) << depth
        self._last = cells + 2 * self._margin - 1
        empty = np.ones((self._last + 1,) * 3, dtype=bool)
        empty[self._cell(points)] = False
        self._away = distance_transform_edt(empty) / cells if len(points) else np.full(empty.shape, np.inf)

    def within(
        self, places: Float[np.ndarray, "N 3"], reach: float | Float[np.ndarray, "N"]
    ) -> Bool[np.ndarray, "N"]:
        return self._away[self._cell(places)] <= reach

    def _cell(self, places: Float[np.ndarray, "N 3"]) -> tuple[Int[np.ndarray, "N"], ...]:
        cell = np.floor(places * self._cells).astype(np.int64) + self._margin
        return tuple(np.clip(cell, 0, self._last).T)


def subdivisions(cells: int) -> int:
    """How often a coarser lattice is subdivided for one of so many cells: as often as two divides them."""
    return min((cells & -cells).bit_length() - 1, _DEEPEST)


def _margin(depth: int) -> int:
    """Coarse cells around the cube."""
    return _MARGIN >> min(depth, 2)


def _distances(
    grid: GradedGrid, fine: Bool[np.ndarray, "T"], planes: Planes, reached: _Reached, cell: float
) -> Float[np.ndarray, "V"]:
    known = np.zeros(len(grid.vertices), dtype=bool)
    known[grid.tets[fine]] = True
    known &= reached.within(grid.vertices, _REACH * cell)
    distances = np.full(len(known), cell)  # beyond the wall of the cube, where solids end
    distances[known] = planes.distance(grid.vertices[known])
    others = ~known & (np.abs(grid.vertices - 0.5) <= 0.5).all(axis=1)
    distances[others] = np.where(planes.inside(grid.vertices[others]), -cell, cell)
    least = 1e-6 * cell  # no vertex lies on the surface by itself
    return np.where(np.abs(distances) < least, least, distances)
