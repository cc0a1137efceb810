"""Tet mesh of a solid made anew from its surface (fTetWild)."""

from importlib.util import find_spec
from typing import ClassVar

import numpy as np

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.tets import TetMesh, tet_volumes
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.isolation import MeshWorker


def can_remesh() -> bool:
    """Whether pytetwild is there."""
    return find_spec("pytetwild") is not None


class RemeshWorker(MeshWorker):
    """fTetWild in a child process; see `MeshWorker`. Its options are `RemeshOptions`."""

    task: ClassVar[str] = "remeshing"
    module: ClassVar[str] = "tetgan.mechanics.remesh_worker"

    def remesh(self, solid: TetMesh) -> TetMesh:
        """Tets that fill the surface of a solid, without the old ones.

        Raises:
            ShapeError: the child raised, crashed, or took too long.
        """
        used, faces = np.unique(boundary_faces(solid.tets), return_inverse=True)
        return self.remesh_surface(TriangleMesh(solid.vertices[used], faces.reshape(-1, 3)))

    def remesh_surface(self, surface: TriangleMesh) -> TetMesh:
        """Tets that fill a surface.

        Raises:
            ShapeError: the child raised, crashed, or took too long.
        """
        answer = self._exchange({"vertices": surface.vertices, "faces": surface.faces})
        vertices, tets = answer["vertices"].reshape(-1, 3), answer["faces"].reshape(-1, 4)
        # fTetWild orders the corners of a tet the other way round.
        turned = tet_volumes(vertices, tets) < 0
        tets[turned] = tets[turned][:, [0, 2, 1, 3]]
        used, compact = np.unique(tets, return_inverse=True)
        return TetMesh(vertices[used], compact.reshape(-1, 4))
