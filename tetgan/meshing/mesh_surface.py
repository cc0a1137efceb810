"""A triangle mesh as the surface of a solid: distance from planes, exact points on it, and the cut."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import igl
import numpy as np
from jaxtyping import Bool, Float

from tetgan.fields.extraction import extract_graded
from tetgan.fields.field import Field
from tetgan.geometry.tets import TetMesh
from tetgan.geometry.triangles import TriangleMesh, area_normals
from tetgan.grids.graded import GradedGrid
from tetgan.grids.lattice import open_lattice
from tetgan.grids.options import Interior
from tetgan.meshing.isosurface import Fit, cut_solid
from tetgan.meshing.planes import Planes, planes_of_field
from tetgan.meshing.relaxation import Projection
from tetgan.solids.solid import SolidMesh

REACH = 3.0
"""Cells from the surface that are fine: what it crosses within `_NEAR`, and two rings around."""

_NEAR = 1.0  # cells from the surface, where planes tell on which side of it a vertex lies: no edge is longer

_KNOWING = 2.0  # cells from the surface, within which tets lend their planes

_TOUCHES = (
    1e-3  # cells: vertices nearer lie outside, so a side in a plane of the lattice is one of its planes
)

_AGREES = 0.5  # least cosine between a face's normal and that of the planes


class Closest(NamedTuple):
    """The nearest points of a mesh, how far they are, squared, and the unit normals of their faces."""

    points: Float[np.ndarray, "N 3"]
    squared: Float[np.ndarray, "N"]
    normals: Float[np.ndarray, "N 3"]


@dataclass(frozen=True, eq=False)
class Triangles(TriangleMesh):
    """A mesh that is asked for its closest points more than once."""

    @cached_property
    def _tree(self) -> igl.AABB:
        tree = igl.AABB()
        tree.init(self.vertices, self.faces)
        return tree

    @cached_property
    def _normals(self) -> Float[np.ndarray, "F 3"]:
        normals = area_normals(self.triangles)
        return normals / np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]

    def closest(self, points: Float[np.ndarray, "N 3"]) -> Closest:
        """The point of the mesh that is nearest to each of some points."""
        if not len(points):
            return Closest(points, np.empty(0), points)
        squared, face, closest = self._tree.squared_distance(self.vertices, self.faces, points)
        return Closest(closest, squared, self._normals[face])


@dataclass(frozen=True, eq=False)
class MeshSurface:
    """A surface of which the triangles are known, not only tangent planes at the centroids of tets.

    The distance is that of the planes, which keeps parts thinner than a tet. What is projected goes on to the
    closest point of the triangles, unless that is far, or on the other side of a thin part.
    """

    planes: Planes
    triangles: Triangles

    def distance(self, points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N"]:
        return self.planes.distance(points)

    def distance_and_normal(
        self, points: Float[np.ndarray, "N 3"]
    ) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
        return self.planes.distance_and_normal(points)

    def projection(self, points: Float[np.ndarray, "N 3"], reach: float) -> Projection:
        """Takes points near the given ones to the planes, then to triangles that are within reach."""
        to_planes = self.planes.projection(points, reach)

        def project(places: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
            projected = to_planes(places)
            closest = self.triangles.closest(projected)
            _, normal = self.planes.distance_and_normal(projected)
            length = np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)
            agrees = np.einsum("nc,nc->n", normal, closest.normals) > _AGREES * length
            return np.where((agrees & (closest.squared <= reach**2))[:, None], closest.points, projected)

        return project


def cut_surface(surface: Triangles, base: int, depth: int, fit: Fit, interior: Interior) -> SolidMesh:
    """The solid within a closed surface in the unit cube: one lattice gives the field, and is cut.

    Args:
        base: cells along the cube of the coarsest level, which is subdivided `depth` times.
        interior: tets inside coarser the further from the surface, or all of one size.
    """
    cell = 1 / (base << depth)
    margin = 1 + int(np.ceil(REACH / 2**depth))
    lattice = open_lattice(base, margin)
    grid, field = extract_graded(
        surface.vertices, surface.faces, lattice, depth, reach=REACH, interior=interior
    )
    length = np.linalg.norm(field.displacement, axis=1)
    knows = (grid.level == depth) & ~grid.green & (length < _KNOWING * cell)
    planes = _planes(grid, field, knows, surface, _TOUCHES * cell)
    distances = _distances(grid, field, knows, planes, cell)
    return cut_solid(grid, distances, MeshSurface(planes, surface), cell, fit)


def _planes(
    grid: GradedGrid, field: Field, chosen: Bool[np.ndarray, "T"], triangles: Triangles, touching: float
) -> Planes:
    """The planes of some tets. Where a centroid is on the surface, no displacement tells the normal."""
    part = Field(field.occupancy[chosen], field.displacement[chosen])
    planes = planes_of_field(part, TetMesh(grid.vertices, grid.tets[chosen]), part.occupancy)
    on = np.abs(planes.distances) < touching
    normals = planes.normals.copy()
    normals[on] = triangles.closest(planes.centroids[on]).normals
    return replace(planes, normals=normals)


def _distances(
    grid: GradedGrid, field: Field, knows: Bool[np.ndarray, "T"], planes: Planes, cell: float
) -> Float[np.ndarray, "V"]:
    """Of the lattice's vertices: that of the planes near the surface, elsewhere only its sign is right."""
    inside, near = np.zeros((2, len(grid.vertices)), dtype=bool)
    inside[grid.tets[field.occupancy]] = True
    corners = grid.tets[knows]
    feet = grid.centroids[knows] + field.displacement[knows]
    away = np.linalg.norm(grid.vertices[corners] - feet[:, None], axis=2)
    near[corners[away <= _NEAR * cell]] = True
    distances = np.where(inside, -cell, cell)
    distances[near] = planes.distance(grid.vertices[near])
    least = _TOUCHES * cell
    return np.where(np.abs(distances) < least, least, distances)
