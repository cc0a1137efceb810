"""A solid tet mesh and its surface."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from tetgan.geometry.tets import TetMesh
from tetgan.geometry.triangles import TriangleMesh


@dataclass(frozen=True)
class SolidChanges:
    """What was done for a valid solid; nothing in mode `paper`.

    Attributes:
        snapped: vertices of the lattice that came to lie on the surface.
        held: vertices of the boundary that the bounds on the tets keep more than a tenth of a cell from it.
        dropped: floating pieces left out: the volume of each, as a share of that of all pieces.
    """

    snapped: int = 0
    held: int = 0
    dropped: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class SolidMesh(TetMesh):
    """Tets, and the boundary faces of their connectivity, on shared vertices.

    Attributes:
        vertices: (V, 3) float64, each used by a tet.
        tets: (T, 4) int64, positive unless displacement inverted them.
        faces: (F, 3) int64, facing outward.
        changes: what was done for it, in mode `solid`.
    """

    faces: Int[np.ndarray, "F 3"]
    changes: SolidChanges = SolidChanges()

    @classmethod
    def empty(cls) -> "SolidMesh":
        """The solid without tets."""
        corners = np.empty((0, 4), dtype=np.int64)
        return cls(np.empty((0, 3)), corners, corners[:, :3])

    @property
    def surface(self) -> TriangleMesh:
        """The boundary, on all vertices."""
        return TriangleMesh(self.vertices, self.faces)
