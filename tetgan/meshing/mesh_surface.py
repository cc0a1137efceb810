"""A triangle mesh as the surface of a solid: distance from planes near it, exact points on it."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import igl
import numpy as np
from jaxtyping import Float

from tetgan.geometry.triangles import TriangleMesh, area_normals
from tetgan.meshing.planes import Planes
from tetgan.meshing.relaxation import Projection

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
