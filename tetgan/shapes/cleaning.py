"""Cleaning of raw triangle meshes before repair."""

import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.triangles import TriangleMesh, area_normals

# A flat or needle-like shape encloses nothing; thinner than this share of its longest side it is refused.
THINNEST = 1e-4


class ShapeError(Exception):
    """A shape that cannot be used; the message is the reason in the catalogue."""


def clean_mesh(soup: TriangleMesh) -> TriangleMesh:
    """The triangles that have an area, and only the vertices that they use.

    The libraries that repair meshes crash, hang or answer nonsense on broken input, so nothing reaches
    them that has not passed here.

    Raises:
        ShapeError: no faces, an index out of range, a coordinate that is not finite, no face with an area,
            or a shape without thickness.
    """
    vertices, faces = soup.vertices, soup.faces
    if not len(faces):
        raise ShapeError("no faces")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise ShapeError("face index out of range")
    used, compact = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], compact.reshape(-1, 3)
    if not np.isfinite(vertices).all() or np.abs(vertices).max() > np.finfo(np.float32).max:
        raise ShapeError("coordinates not finite")
    faces = faces[_doubled_areas(vertices, faces) > 0]
    if not len(faces):
        raise ShapeError("no face with an area")
    used, compact = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], compact.reshape(-1, 3)
    if _thickness(vertices) < THINNEST:
        raise ShapeError("flat: a shape without thickness")
    return TriangleMesh(vertices, faces)


def _doubled_areas(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]
) -> Float[np.ndarray, "F"]:
    """Twice the area of each face in units of the bounding box, 0 below what float32 can tell from a line."""
    size = np.ptp(vertices, axis=0).max()
    if size == 0:
        return np.zeros(len(faces))
    doubled = np.linalg.norm(area_normals(((vertices - vertices.mean(axis=0)) / size)[faces]), axis=1)
    return np.where(doubled > 1e-12, doubled, 0.0)


def _thickness(vertices: Float[np.ndarray, "V 3"]) -> float:
    """Extent along the thinnest principal axis as a share of that along the longest."""
    centred = vertices - vertices.mean(axis=0)
    axes = np.linalg.eigh(centred.T @ centred)[1]
    extent = np.ptp(centred @ axes, axis=0)
    return float(extent.min() / extent.max())
