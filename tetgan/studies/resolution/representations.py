"""One exact torus, represented in tets and in voxels."""

import numpy as np

from tetgan.fields.field import vertex_operator
from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.triangles import TriangleMesh
from tetgan.grids.grid import TetGrid
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.studies.resolution.torus import Torus

DEFORMED, UNDEFORMED, BINARY, BLOCKY, DISTANCE = (
    "deformed tets",
    "undeformed tets",
    "binary voxels, marching cubes",
    "binary voxels, blocky",
    "distance voxels, marching cubes",
)
"""The representations; the last two are not in the paper's figure."""

NUMBERS = {DEFORMED: 4, UNDEFORMED: 1, BINARY: 1, BLOCKY: 1, DISTANCE: 1}
"""Numbers stored for each tet or voxel: a deformed tet has three of displacement beside its occupancy."""

PAPER = {DEFORMED: 41, UNDEFORMED: 161, BINARY: 301}
"""Resolutions that the paper's torus needed."""

_CHUNK = 500_000


def undeformed_surface(torus: Torus, grid: TetGrid) -> TriangleMesh:
    """The blocky boundary of the tets whose centroid lies inside."""
    inside = np.empty(len(grid.tets), dtype=bool)
    for start in range(0, len(inside), _CHUNK):  # all corners of a fine lattice would fill the memory
        corners = grid.vertices[grid.tets[start : start + _CHUNK]]
        inside[start : start + _CHUNK] = torus.signed_distance(corners.mean(axis=1)) < 0
    used, compact = np.unique(grid.tets[inside], return_inverse=True)
    return TriangleMesh(grid.vertices[used], boundary_faces(compact.reshape(-1, 4)))


def deformed_surface(torus: Torus, grid: TetGrid) -> TriangleMesh:
    """The same boundary, moved by the torus's own displacement field (Eq. 3)."""
    field, options = torus.field(grid.centroids), MeshingOptions(mode="paper")
    # Eq. 5 drops what a network got wrong; an exact field has nothing to drop.
    return build_solid(field, grid, vertex_operator(grid), np.inf, options, smoothing=False).surface
