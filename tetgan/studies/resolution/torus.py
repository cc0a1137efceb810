"""An exact torus: inside, distance, nearest point and uniform points in closed form."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from tetgan.fields.field import Field
from tetgan.geometry.triangles import TriangleMesh

Points = Float[np.ndarray, "P 3"]


# Nodes of the table that turns uniform numbers into angles around the tube; its error is below 1e-7.
_NODES = 8193


@dataclass(frozen=True)
class Torus:
    """A tube of radius `minor` along a circle of radius `major` about the cube's middle, across `axis`."""

    major: float
    minor: float
    axis: tuple[float, float, float]

    def signed_distance(self, points: Points) -> Float[np.ndarray, "P"]:
        """Distance to the surface, negative inside."""
        along, across = self._split(points)
        return np.hypot(np.linalg.norm(across, axis=1) - self.major, along) - self.minor

    def closest_points(self, points: Points) -> Points:
        """Nearest points of the surface; one of them for points on the axis or in the middle of the tube."""
        along, across = self._split(points)
        outward = _directions(across)
        radial = np.linalg.norm(across, axis=1) - self.major
        # The cut through the tube: how far out, how far along the axis.
        section = _directions(np.stack([radial, along], axis=1))
        ring = (self.major + self.minor * section[:, :1]) * outward
        return self._join(self.minor * section[:, 1], ring)

    def sample(self, count: int, seed: int) -> Points:
        """Points uniform by area."""
        turn, share = np.random.default_rng(seed).random((2, count))
        # Area grows with the distance from the axis: the angle around the tube has density R + r cos.
        nodes = np.linspace(0, 2 * np.pi, _NODES)
        area = self.major * nodes + self.minor * np.sin(nodes)
        around = np.interp(share * area[-1], area, nodes)
        outward = np.stack([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)], axis=1)
        ring = (self.major + self.minor * np.cos(around))[:, None] * outward
        return self._join(self.minor * np.sin(around), ring)

    def field(self, points: Points) -> Field:
        """Field of the torus on a tetrahedral grid with these centroids."""
        displacement = self.closest_points(points) - points
        return Field(self.signed_distance(points) < 0, displacement.astype(np.float32))

    def mesh(self, around_ring: int, around_tube: int) -> TriangleMesh:
        """A closed triangle mesh with its vertices on the surface, facing outward."""
        turn, around = np.meshgrid(
            np.arange(around_ring) * 2 * np.pi / around_ring,
            np.arange(around_tube) * 2 * np.pi / around_tube,
            indexing="ij",
        )
        distance = (self.major + self.minor * np.cos(around)).ravel()[:, None]
        outward = np.stack([np.cos(turn), np.sin(turn)], axis=-1).reshape(-1, 2)
        vertices = self._join(self.minor * np.sin(around).ravel(), distance * outward)
        here = np.arange(around_ring * around_tube).reshape(around_ring, around_tube)
        ahead, beside = np.roll(here, -1, axis=0), np.roll(here, -1, axis=1)
        both = np.roll(ahead, -1, axis=1)
        faces = np.stack([here, ahead, both, here, both, beside], axis=-1).reshape(-1, 3)
        return TriangleMesh(vertices, faces)

    @cached_property
    def _frame(self) -> Float[np.ndarray, "3 3"]:
        """Rows: the unit axis, then two across it that make a right-handed frame."""
        axis = np.array(self.axis) / np.linalg.norm(self.axis)
        across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
        across /= np.linalg.norm(across)
        return np.stack([axis, across, np.cross(axis, across)])

    def _split(self, points: Points) -> tuple[Float[np.ndarray, "P"], Float[np.ndarray, "P 2"]]:
        """Coordinates about the middle: along the axis, and across it."""
        local = (points - 0.5) @ self._frame.T
        return local[:, 0], local[:, 1:]

    def _join(self, along: Float[np.ndarray, "P"], across: Float[np.ndarray, "P 2"]) -> Points:
        return np.column_stack([along, across]) @ self._frame + 0.5


def _directions(vectors: Float[np.ndarray, "P 2"]) -> Float[np.ndarray, "P 2"]:
    """Unit vectors; the first axis in place of zero, where every direction is as good."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    first = np.broadcast_to(np.array([1.0, 0.0]), vectors.shape).copy()
    return np.divide(vectors, lengths, out=first, where=lengths > 0)
