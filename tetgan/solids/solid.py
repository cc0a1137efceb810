"""A solid tet mesh and its surface."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from tetgan.geometry.tets import TetMesh
from tetgan.geometry.triangles import TriangleMesh


@dataclass(frozen=True)
class SolidChanges:
    """Changes of the occupancy that Eq. 5 left, made for a valid solid; none in mode `paper`.

    Attributes:
        tets_added: tets filled for the sake of a manifold boundary.
        tets_removed: tets emptied for its sake; those of dropped pieces do not count.
        changed: tets added and removed, as a share of the tets that Eq. 5 left.
        gaps: pinches opened by pulling occupied tets back from a vertex.
        seams: pinches closed by pulling empty tets back.
        dropped: floating pieces left out: the volume of each, as a share of that of all tets that Eq. 5 left.
        cavities: voids inside that the outside does not reach; they stay.
    """

    tets_added: int = 0
    tets_removed: int = 0
    changed: float = 0.0
    gaps: int = 0
    seams: int = 0
    dropped: tuple[float, ...] = ()
    cavities: int = 0


@dataclass(frozen=True, eq=False)
class SolidMesh(TetMesh):
    """Tets, and the boundary faces of their connectivity, on shared vertices.

    Attributes:
        vertices: (V, 3) float64, each used by a tet.
        tets: (T, 4) int64, positive unless displacement inverted them.
        faces: (F, 3) int64, facing outward.
        changes: of the occupancy, in mode `solid`.
    """

    faces: Int[np.ndarray, "F 3"]
    changes: SolidChanges = SolidChanges()

    @property
    def surface(self) -> TriangleMesh:
        """The boundary, on all vertices."""
        return TriangleMesh(self.vertices, self.faces)
