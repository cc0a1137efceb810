"""Points sampled on a surface, and counts of its non-manifold edges and vertices."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Int

from tetgan.evaluation.chamfer import SurfaceSample
from tetgan.geometry.adjacency import unique_edges
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.sampling import sample_surface


def draw_sample(surface: TriangleMesh, points: int, seed: int) -> SurfaceSample:
    """Area-uniform points and normals of a surface."""
    return SurfaceSample(*sample_surface(surface.vertices, surface.faces, points, seed))


class Topology(NamedTuple):
    """Manifold, boundary and non-manifold edges of a surface; each field is a metric.

    Attributes:
        manifold_edges, boundary_edges, nonmanifold_edges: shares of edges with two faces, one, and more.
        manifold_shapes: 1 where every edge has two faces and those around each vertex form one fan, else 0.
    """

    manifold_edges: float
    boundary_edges: float
    nonmanifold_edges: float
    manifold_shapes: float


def measure_topology(faces: Int[np.ndarray, "F 3"]) -> Topology:
    """Count the faces of every edge, and look for pinched vertices.

    Raises:
        ValueError: no faces.
    """
    if not len(faces):
        raise ValueError("no faces, so no edges")
    edges, edge_of_side = unique_edges(faces)
    faces_of_edge = np.bincount(edge_of_side.ravel(), minlength=len(edges))
    manifold, boundary = float((faces_of_edge == 2).mean()), float((faces_of_edge == 1).mean())
    closed = bool((faces_of_edge == 2).all())
    return Topology(
        manifold, boundary, float((faces_of_edge > 2).mean()), float(closed and not _is_pinched(faces))
    )


def _is_pinched(faces: Int[np.ndarray, "F 3"]) -> bool:
    """Whether the faces around some vertex fall into several fans."""
    import igl  # noqa: PLC0415

    # igl counts a vertex without faces as pinched, so number the used ones anew.
    used, compact = np.unique(faces, return_inverse=True)
    fans = igl.is_vertex_manifold(compact.reshape(-1, 3).astype(np.int64))
    return not bool(fans[: len(used)].all())
