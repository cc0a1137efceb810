"""From a field to a solid mesh."""

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse

from tetgan.fields.field import Field, VertexField
from tetgan.grids.adjacency import boundary_faces
from tetgan.grids.grid import TetGrid
from tetgan.meshing.filtering import filter_occupancy
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.smoothing import smooth_vertices
from tetgan.meshing.solid import SolidMesh


def build_solid(
    field: Field | VertexField,
    grid: TetGrid,
    operator: sparse.csr_array,
    mu: float,
    options: MeshingOptions,
    *,
    smoothing: bool,
) -> SolidMesh:
    """Filter (Eq. 5), displace the boundary (Eq. 3) and, if asked, smooth it (Eq. 4).

    Only boundary vertices move: moving the others too inverts more tets, and gains the surface nothing.
    Even so a few per cent of the tets may come out inverted; `quality_record` counts them.

    Args:
        grid: the finest grid of the hierarchy, which the field lives on.
        operator: `vertex_operator(grid)`, made once for many fields.
        mu: the data set's mean displacement of surface tets.

    Returns:
        The solid; without tets where nothing is occupied.
    """
    tets = grid.tets[filter_occupancy(field, grid.neighbors, mu, options.gamma)]
    used, compact = np.unique(tets, return_inverse=True)
    tets = compact.reshape(-1, 4)
    faces = boundary_faces(tets)
    vertices, displacement = grid.vertices[used], _displacement_at(used, field, operator)
    boundary = np.unique(faces)
    vertices[boundary] += displacement[boundary]
    if smoothing:
        vertices = smooth_vertices(vertices, displacement, faces, options.beta)
    return SolidMesh(vertices, tets, faces)


def _displacement_at(
    vertices: Int[np.ndarray, "N"], field: Field | VertexField, operator: sparse.csr_array
) -> Float[np.ndarray, "N 3"]:
    """Displacement of some vertices: by Eq. 3, or as the field itself has it."""
    if isinstance(field, VertexField):
        return field.vertex_displacement[vertices].astype(np.float64)
    return operator[vertices] @ field.displacement.astype(np.float64)
