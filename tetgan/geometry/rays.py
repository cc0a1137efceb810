"""Rays against triangles, by Embree: what they hit, how far away, and which points see the outside."""

from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float, Int

# Start of a ray past a triangle, in the units of a shape of size 1: clear of it in float32.
_PAST = 1e-5


class Visibility:
    """Rays against one set of triangles (F, 3, 3)."""

    def __init__(self, triangles: Float[np.ndarray, "F 3 3"]) -> None:
        from embreex import mesh_construction  # noqa: PLC0415
        from embreex.rtcore_scene import EmbreeScene  # noqa: PLC0415

        self._scene = EmbreeScene()
        mesh_construction.TriangleMesh(self._scene, np.ascontiguousarray(triangles, dtype=np.float32))

    def sees_out(
        self,
        origins: Float[np.ndarray, "P 3"],
        directions: Float[np.ndarray, "#P 3"],
        reach: float = 1e30,
    ) -> Bool[np.ndarray, "P"]:
        """Whether a ray from each origin meets nothing within `reach` times the length of its direction."""
        rays = np.ascontiguousarray(np.broadcast_to(directions, origins.shape), dtype=np.float32)
        lengths = np.full(len(rays), reach, dtype=np.float32)
        return self._scene.run(origins.astype(np.float32), rays, dists=lengths, query="OCCLUDED") == -1

    def first_wall(
        self, origins: Float[np.ndarray, "P 3"], direction: Float[np.ndarray, "3"]
    ) -> Float[np.ndarray, "P"]:
        """Thickness, across it, of the first wall met, from the ray's entry to its exit; inf if none."""
        _, entries, normals = self._first_hit(origins, direction)
        met = np.isfinite(entries)
        thickness = np.full(len(origins), np.inf)
        inside = origins[met] + (entries[met, None] + _PAST) * direction
        _, through, _ = self._first_hit(inside, direction)
        thickness[met] = (through + _PAST) * np.abs(normals[met] @ direction)
        return thickness

    def distances(
        self, origins: Float[np.ndarray, "P 3"], directions: Float[np.ndarray, "P 3"]
    ) -> Float[np.ndarray, "P"]:
        """Distance along each unit direction to the first triangle, inf if there is none."""
        return self._first_hit(origins, directions)[1]

    def first_faces(
        self, origins: Float[np.ndarray, "P 3"], direction: Float[np.ndarray, "3"]
    ) -> tuple[Int[np.ndarray, "P"], Float[np.ndarray, "P"]]:
        """Number of the first triangle that each ray meets, -1 if there is none, and its distance."""
        faces, distances, _ = self._first_hit(origins, direction)
        return faces, distances

    def _first_hit(
        self, origins: Float[np.ndarray, "P 3"], directions: Float[np.ndarray, "*rays 3"]
    ) -> tuple[Int[np.ndarray, "P"], Float[np.ndarray, "P"], Float[np.ndarray, "P 3"]]:
        """The first triangle, -1 if there is none; its distance, inf if there is none; its unit normal."""
        rays = np.ascontiguousarray(np.broadcast_to(directions, origins.shape), dtype=np.float32)
        hits = self._scene.run(origins.astype(np.float32), rays, output=True)
        faces = hits["primID"].astype(np.int64)
        normals = hits["Ng"] / np.maximum(np.linalg.norm(hits["Ng"], axis=1, keepdims=True), 1e-30)
        distances = np.where(faces == -1, np.inf, hits["tfar"]).astype(np.float64)
        return faces, distances, normals.astype(np.float64)

    def sees_out_on_side(
        self, origins: Float[np.ndarray, "P 3"], normals: Float[np.ndarray, "P 3"], count: int
    ) -> Bool[np.ndarray, "P"]:
        """Whether any of `count` spread directions on the side of the normal meets nothing.

        Most points that see out do so along one of the first few directions, so each round asks only for
        those still in doubt.
        """
        seen = np.zeros(len(origins), dtype=bool)
        for direction in spread_directions(count):
            doubtful = np.flatnonzero(~seen)
            towards = np.where(normals[doubtful] @ direction < 0, -1.0, 1.0)[:, None] * direction
            seen[doubtful] = self.sees_out(origins[doubtful], towards)
        return seen


@lru_cache
def spread_directions(count: int) -> Float[np.ndarray, "N 3"]:
    """Unit vectors spread evenly over the upper half of the sphere, in an order that spreads from the start.

    The golden spiral, visited by the van der Corput order of its turns; with their opposites they cover the
    sphere twice as densely, and a point picks the one on its own side.
    """
    ranks = np.argsort(np.argsort([_radical_inverse(index) for index in range(count)]))
    height = 1 - (ranks + 0.5) / count
    turn = np.pi * (3 - np.sqrt(5)) * ranks
    radius = np.sqrt(1 - height**2)
    return np.stack([radius * np.cos(turn), height, radius * np.sin(turn)], axis=1)


def _radical_inverse(index: int) -> float:
    """Binary digits mirrored at the point."""
    return int(f"{index:b}"[::-1], 2) / 2 ** index.bit_length() if index else 0.0
