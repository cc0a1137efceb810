"""Surfaces from files, and what can be told of them without comparing."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh
from jaxtyping import Float, Int

from tetgan.evaluation.chamfer import SurfaceSample
from tetgan.grids.adjacency import unique_edges
from tetgan.shapes.sampling import sample_surface


class Surface(NamedTuple):
    """Triangles with indices into vertices."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]


def read_surface(path: Path) -> Surface | None:
    """The triangles of a file, exactly as stored; None when there is no file, no face, or no area.

    A generated shape may be empty: that is a result to count, not an error.
    """
    if not path.is_file():
        return None
    mesh = trimesh.load_mesh(path, process=False)
    faces = np.asarray(mesh.faces)
    if not len(faces) or not mesh.area > 0:
        return None
    return Surface(np.asarray(mesh.vertices, dtype=np.float64), faces.astype(np.int64))


def draw_sample(surface: Surface, points: int, seed: int) -> SurfaceSample:
    """Area-uniform points and normals of a surface."""
    return SurfaceSample(*sample_surface(surface.vertices, surface.faces, points, seed))


def manifold_edge_share(faces: Int[np.ndarray, "F 3"]) -> float:
    """Share of edges with exactly two faces; 1 for a closed manifold surface.

    Raises:
        ValueError: no faces.
    """
    if not len(faces):
        raise ValueError("no faces, so no edges")
    edges, edge_of_side = unique_edges(faces)
    return float((np.bincount(edge_of_side.ravel(), minlength=len(edges)) == 2).mean())
