"""Tangent planes that the tets of a field know of its surface, and the signed distance they agree on."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from tetgan.fields.field import Field
from tetgan.geometry.tets import TetMesh

_NEIGHBOURS = 12  # planes asked at a point

_BLUR = 0.3  # a plane's foot is as well known as this share of how far away its centroid is

_CONTRADICTION = 0.01  # weight of planes that face the other way, over that of planes that agree

_CHUNK = 1 << 12  # points at once

_BLIND = 1e-3  # of the typical edge: a shorter displacement has no direction


@dataclass(frozen=True, eq=False)
class Planes:
    """Tangent planes of a surface, each known at the centroid of a tet.

    The distance to the planes of the nearest centroids, averaged, keeps parts thinner than a tet, which the
    distance to the closest point of the surface, interpolated linearly, loses: a plane goes on through the
    other side of a thin part, where its value is still that of an inside. The planes that count most touch
    the surface near the point and face the way that most do: the planes of the other side of a thin part, and
    those around a convex one, all of which lie outside of it, would make both thicker.

    Attributes:
        centroids: (T, 3) where each plane is known.
        distances: (T,) of the centroids, signed: negative inside.
        normals: (T, 3) of the planes, outward, of length 1; 0 where no direction is known.
    """

    centroids: Float[np.ndarray, "T 3"]
    distances: Float[np.ndarray, "T"]
    normals: Float[np.ndarray, "T 3"]

    @cached_property
    def _tree(self) -> KDTree:
        return KDTree(self.centroids)

    @property
    def feet(self) -> Float[np.ndarray, "T 3"]:
        """The point of the surface that each centroid knows."""
        return self.centroids - self.distances[:, None] * self.normals

    def inside(self, points: Float[np.ndarray, "N 3"]) -> Bool[np.ndarray, "N"]:
        """Whether the nearest centroid lies inside: good far from the surface."""
        return self.distances[self._tree.query(points)[1]] < 0

    def distance(self, points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N"]:
        """Signed distance to the surface, negative inside."""
        return self.distance_and_normal(points)[0]

    def distance_and_normal(
        self, points: Float[np.ndarray, "N 3"]
    ) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
        """The signed distance, and the mean of the normals: its gradient, but for that of the weights."""
        distance, normal = np.empty(len(points)), np.empty((len(points), 3))
        for rows in _chunks(len(points)):
            distance[rows], normal[rows] = self._mean(points[rows], self._nearest(points[rows]))
        beyond = (
            np.abs(points - 0.5).max(axis=1) - 0.5
        )  # fields end at the wall of the cube, and so do solids
        return np.maximum(distance, beyond), normal

    def project(self, points: Float[np.ndarray, "N 3"], reach: float) -> Float[np.ndarray, "N 3"]:
        """Points of the cube on the surface near the given ones: two steps of Newton, none beyond `reach`."""
        return self.projection(points, reach)(points)

    def projection(
        self, points: Float[np.ndarray, "N 3"], reach: float
    ) -> Callable[[Float[np.ndarray, "N 3"]], Float[np.ndarray, "N 3"]]:
        """`project` of points that stay near the given ones, whose planes are looked for once."""
        nearest = self._nearest(points)

        def project(places: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
            projected = places.copy()
            for rows in _chunks(len(places)):
                for _ in range(2):
                    distance, normal = self._mean(projected[rows], nearest[rows])
                    squares = np.maximum((normal**2).sum(axis=1), 0.25)  # normals that disagree: a short mean
                    projected[rows] -= np.clip(distance / squares, -reach, reach)[:, None] * normal
            return projected.clip(0, 1)

        return project

    def _nearest(self, points: Float[np.ndarray, "N 3"]) -> Int[np.ndarray, "N K"]:
        """The planes that are asked at each point."""
        count = min(_NEIGHBOURS, len(self.centroids))
        return self._tree.query(points, k=np.arange(1, count + 1))[1]

    def _mean(
        self, points: Float[np.ndarray, "N 3"], nearest: Int[np.ndarray, "N K"]
    ) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
        normals, heights = self.normals[nearest], self.distances[nearest]
        offsets = points[:, None] - self.centroids[nearest]
        values = heights + np.einsum("nkc,nkc->nk", offsets, normals)
        squares = np.einsum("nkc,nkc->nk", offsets, offsets)
        # The square of how far the foot is, and of how far it may be.
        feet = squares + 2 * heights * values - heights**2 + _BLUR**2 * squares
        weights = 1 / np.maximum(squares * feet, np.finfo(float).tiny ** 0.5)
        mean = np.einsum("nk,nkc->nc", weights, normals)
        mean /= np.maximum(np.sqrt(np.einsum("nc,nc->n", mean, mean)), np.finfo(float).tiny)[:, None]
        weights *= np.maximum(np.einsum("nkc,nc->nk", normals, mean), 0) + _CONTRADICTION
        weights /= weights.sum(axis=1, keepdims=True)
        return (weights * values).sum(axis=1), np.einsum("nk,nkc->nc", weights, normals)


def _chunks(count: int) -> Iterator[slice]:
    return (slice(begin, begin + _CHUNK) for begin in range(0, count, _CHUNK))


def planes_of_field(field: Field, grid: TetMesh, occupancy: Bool[np.ndarray, "T"]) -> Planes:
    """The planes of a field's tets.

    Args:
        occupancy: of the field after its filter (Eq. 5); tets that it has emptied contradict themselves, and
            are left out.

    Where a centroid lies on the surface its displacement tells no direction, and its neighbours' normals do.
    A field without displacements says on which side a centroid lies, and no more: all are then a quarter of
    the typical edge away from a surface of no direction.
    """
    kept = occupancy == field.occupancy
    displacement = field.displacement.astype(np.float64)
    side = np.where(occupancy, -1.0, 1.0)
    length = np.linalg.norm(displacement, axis=1)
    edge = typical_edge(grid)
    if not length.any():
        return Planes(grid.centroids[kept], side[kept] * edge / 4, np.zeros_like(displacement[kept]))
    normals = -side[:, None] * displacement / np.maximum(length, np.finfo(float).tiny)[:, None]
    blind = np.flatnonzero(length < _BLIND * edge)
    if len(blind):
        padded = np.concatenate([normals * (length >= _BLIND * edge)[:, None], np.zeros((1, 3))])
        around = padded[grid.neighbors[blind]].sum(axis=1)  # a missing neighbour reads the last row
        normals[blind] = around / np.maximum(np.linalg.norm(around, axis=1), np.finfo(float).tiny)[:, None]
    return Planes(grid.centroids[kept], (side * length)[kept], normals[kept])


def typical_edge(grid: TetMesh) -> float:
    """Edge of a regular tet of the mean volume."""
    return float((grid.volumes.mean() * 6 * np.sqrt(2)) ** (1 / 3))
