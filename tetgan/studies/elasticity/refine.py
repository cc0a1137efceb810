"""Finer tets for the same body."""

import numpy as np
import skfem

from tetgan.grids.grid import tet_volumes
from tetgan.rendering.meshes import Solid


def cut_tets(solid: Solid, times: int) -> Solid:
    """Each tet cut into eight, so many times; the old vertices come first."""
    if times == 0:
        return solid
    mesh = skfem.MeshTet(np.ascontiguousarray(solid.vertices.T), np.ascontiguousarray(solid.tets.T)).refined(
        times
    )
    vertices, tets = np.ascontiguousarray(mesh.p.T), mesh.t.T.astype(np.int64)
    turned = tet_volumes(vertices, tets) < 0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    return Solid(vertices, tets)
