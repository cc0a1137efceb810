"""Triangle meshes, and what follows from them: areas, enclosed volume, components."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.components import label_components


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles: `vertices` (V, 3) in any unit, y up, and `faces` (F, 3) into them."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]

    @property
    def triangles(self) -> Float[np.ndarray, "F 3 3"]:
        """Corner positions of every face."""
        return self.vertices[self.faces]

    @property
    def volume(self) -> float:
        """Signed volume that closed faces enclose, in cubed units: positive where they face outward."""
        return float(six_cones(self.triangles, 0.5).sum() / 6)

    @property
    def components(self) -> int:
        """Number of pieces of faces, joined by vertices."""
        used, compact = np.unique(self.faces, return_inverse=True)
        a, b, c = compact.reshape(-1, 3).T
        labels = label_components(np.concatenate([a, b]), np.concatenate([b, c]), len(used))
        return int(labels.max(initial=-1) + 1)


def join_meshes(meshes: Sequence[TriangleMesh]) -> TriangleMesh:
    """All meshes as one, in their order; nothing is welded. No faces for no meshes."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]
    return TriangleMesh(
        np.concatenate([np.empty((0, 3)), *(mesh.vertices for mesh in meshes)]),
        np.concatenate([np.empty((0, 3), dtype=np.int64), *faces]),
    )


def area_normals(triangles: Float[np.ndarray, "*N 3 3"]) -> Float[np.ndarray, "*N 3"]:
    """Normals of triangles, twice as long as their areas, towards where their corners turn left."""
    start = triangles[..., 0, :]
    return np.cross(triangles[..., 1, :] - start, triangles[..., 2, :] - start)


def six_cones(
    triangles: Float[np.ndarray, "F 3 3"], apex: float | Float[np.ndarray, "3"]
) -> Float[np.ndarray, "F"]:
    """Six times the signed volume of the tet from each triangle to a point.

    Over a closed surface that faces outward they add up to six times what it encloses, whatever the point;
    one near the surface loses least to rounding.
    """
    return np.linalg.det(triangles - apex)
