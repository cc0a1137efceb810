"""The lattice that a solid is cut from: fine where its surface is, and a signed distance at its vertices."""

from functools import partial
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from tetgan.grids.graded import GradedGrid, graded_grid
from tetgan.grids.lattice import open_lattice
from tetgan.meshing.planes import Planes

Interior = Literal["fine", "graded"]

_REACH = 3.0  # cells around the surface that are fine: it crosses edges of one, and two rings make way for it

_BEYOND = 1.0  # cells around the cube that a solid may reach into

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
        tree = KDTree(np.concatenate(near))
        choose = partial(_choose, planes=planes, near=tree, reach=_REACH * cell, fine=interior == "fine")
        grid = graded_grid(open_lattice(cells >> depth, _MARGIN >> min(depth, 2)), depth, choose)
        fine = (grid.level == depth) & ~grid.green
        distances = _distances(grid, fine, planes, tree, cell)
        unexpected = _around_crossings(grid.tets, distances) & ~fine
        if not unexpected.any():
            return grid, distances
        near.append(grid.centroids[unexpected])


def subdivisions(cells: int) -> int:
    """How often a coarser lattice is subdivided for one of so many cells: as often as two divides them."""
    return min((cells & -cells).bit_length() - 1, _DEEPEST)


def _choose(
    level: int,
    corners: Float[np.ndarray, "N 4 3"],
    *,
    planes: Planes,
    near: KDTree,
    reach: float,
    fine: bool,
) -> Bool[np.ndarray, "N"]:
    """Which tets of a level to subdivide: those that come within reach, and if so asked all inside."""
    centroids = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centroids[:, None], axis=2).max(axis=1) + reach
    chosen = near.query(centroids, distance_upper_bound=radius.max(initial=0))[0] <= radius
    if fine:
        chosen[~chosen] = planes.inside(centroids[~chosen])
    return chosen


def _distances(
    grid: GradedGrid, fine: Bool[np.ndarray, "T"], planes: Planes, near: KDTree, cell: float
) -> Float[np.ndarray, "V"]:
    of_fine, beyond = np.zeros((2, len(grid.vertices)), dtype=bool)
    of_fine[grid.tets[fine]] = True
    beyond[((grid.vertices < -_BEYOND * cell) | (grid.vertices > 1 + _BEYOND * cell)).any(axis=1)] = True
    close = np.isfinite(near.query(grid.vertices, distance_upper_bound=_REACH * cell)[0])
    known = of_fine & close & ~beyond
    distances = np.full(len(known), cell)
    distances[known] = planes.distance(grid.vertices[known])
    unknown = ~known & ~beyond
    distances[unknown] = np.where(planes.inside(grid.vertices[unknown]), -cell, cell)
    least = 1e-6 * cell  # no vertex lies on the surface by itself
    return np.where(np.abs(distances) < least, least, distances)


def _around_crossings(
    tets: Int[np.ndarray, "T 4"], distances: Float[np.ndarray, "V"]
) -> Bool[np.ndarray, "T"]:
    """Tets in which the distance changes its sign, and two rings around them."""
    negative = (distances < 0)[tets].sum(axis=1)
    around = (negative > 0) & (negative < 4)
    near = np.zeros(len(distances), dtype=bool)
    for _ in range(2):
        near[tets[around]] = True
        around = near[tets].any(axis=1)
    return around
