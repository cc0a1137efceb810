"""Tet meshes; volume, orientation, angles and quality of tets."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import igl.predicates
import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.adjacency import EDGES, FACES, face_neighbors, unique_edges
from tetgan.geometry.triangles import area_normals


@dataclass(frozen=True, eq=False)
class TetMesh:
    """Tets on shared vertices.

    Attributes:
        vertices: (V, 3) float64.
        tets: (T, 4) int64 vertex indices.
    """

    vertices: Float[np.ndarray, "V 3"]
    tets: Int[np.ndarray, "T 4"]

    @cached_property
    def centroids(self) -> Float[np.ndarray, "T 3"]:
        """Mean of the four vertices."""
        return self.vertices[self.tets].mean(axis=1)

    @cached_property
    def volumes(self) -> Float[np.ndarray, "T"]:
        """Signed volumes, positive where det(v1-v0, v2-v0, v3-v0) is."""
        return tet_volumes(self.vertices, self.tets)

    @cached_property
    def neighbors(self) -> Int[np.ndarray, "T 4"]:
        """Slot s is the tet across the face opposite local vertex s; -1 where there is none."""
        return face_neighbors(self.tets)

    @cached_property
    def edges(self) -> Int[np.ndarray, "E 2"]:
        """Every edge once, smaller vertex first."""
        return unique_edges(self.tets)[0]


def tet_volumes(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> Float[np.ndarray, "T"]:
    """Signed volume of each tet: det(v1-v0, v2-v0, v3-v0) / 6."""
    a, b, c = np.moveaxis(vertices[tets[:, 1:]] - vertices[tets[:, :1]], 1, 0)
    return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6


def orientations(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "T"]:
    """Sign of each tet's volume: 1, 0 where it is flat, -1 where it is inverted.

    Exact for the coordinates as they are stored, where a volume in floating point can have either sign
    (Shewchuk 1997, through libigl). Coordinates must be finite.
    """
    corners = np.asarray(vertices, dtype=np.float64)[tets]
    # The predicate is positive where the last point lies below the plane of the others.
    signs = igl.predicates.orient3d(*(np.ascontiguousarray(corners[:, k]) for k in range(4)))
    return -signs.astype(np.int64)


def dihedral_angles(
    vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]
) -> Float[np.ndarray, "T 6"]:
    """Angles in degrees between the two faces at each edge, in the order of `EDGES`.

    A tet flattened to a plane has angles of 0 and 180; at a face without area the angle is 0.
    """
    normals = area_normals(vertices[tets[:, FACES]])
    # Faces i and j meet at the edge that has neither of the vertices i and j: the opposite one in EDGES.
    one, other = np.moveaxis(normals[:, EDGES[::-1]], 2, 0)
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    cosine = -np.einsum("tec,tec->te", one, other)
    return np.degrees(np.where(one.any(axis=-1) & other.any(axis=-1), np.arctan2(sine, cosine), 0.0))


def radius_ratios(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> Float[np.ndarray, "T"]:
    """Three times the radius of the inscribed sphere over that of the circumscribed one.

    1 for a regular tet, 0 for a flat one; like the angles it does not see whether a tet is inverted.
    """
    corners = vertices[tets]
    one, two, three = np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 0)
    areas = np.linalg.norm(area_normals(corners[:, FACES]), axis=2)
    crosses = np.cross(two, three), np.cross(three, one), np.cross(one, two)
    squares = ((edge**2).sum(axis=1)[:, None] for edge in (one, two, three))
    # With v six times the volume: inner radius v / sum(areas), outer |w| / 2v; areas are doubled here.
    w = np.linalg.norm(sum(square * cross for square, cross in zip(squares, crosses, strict=True)), axis=1)
    v = (one * crosses[0]).sum(axis=1)
    below = areas.sum(axis=1) * w
    return np.divide(6 * v**2, below, out=np.zeros_like(v), where=below > 0)


class TetShapes(NamedTuple):
    """Six times the volume of each tet, and the cosine of its least dihedral angle."""

    volume: Float[np.ndarray, "*N"]
    cosine: Float[np.ndarray, "*N"]


def tet_shapes(points: Float[np.ndarray, "4 3 *N"]) -> TetShapes:
    """Of tets whose corners are given, coordinate by coordinate: much the fastest layout."""
    a, b, c = points[1:] - points[:1]
    one, two, three = _cross(b, c), _cross(c, a), _cross(a, b)
    normals = (-(one + two + three), one, two, three)  # inward, as long as twice the face's area
    lengths = [np.sqrt(np.maximum(_dot(normal, normal), np.finfo(float).tiny)) for normal in normals]
    cosine = np.full(points.shape[2:], -1.0)
    for i, j in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)):
        between = _dot(normals[i], normals[j])
        between /= lengths[i] * lengths[j]
        np.maximum(cosine, np.negative(between, out=between), out=cosine)
    return TetShapes(_dot(a, one), cosine)


def six_volumes(points: Float[np.ndarray, "4 3 *N"]) -> Float[np.ndarray, "*N"]:
    """The volume of `tet_shapes` alone."""
    a, b, c = points[1:] - points[:1]
    return _dot(a, _cross(b, c))


def _cross(a: Float[np.ndarray, "3 *N"], b: Float[np.ndarray, "3 *N"]) -> Float[np.ndarray, "3 *N"]:
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        np.multiply(a[j], b[k], out=out[i])
        out[i] -= a[k] * b[j]
    return out


def _dot(a: Float[np.ndarray, "3 *N"], b: Float[np.ndarray, "3 *N"]) -> Float[np.ndarray, "*N"]:
    total = a[0] * b[0]
    total += a[1] * b[1]
    total += a[2] * b[2]
    return total
