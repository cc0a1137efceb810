"""A solid tet mesh and its surface."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """Tets, and the boundary faces of their connectivity, on shared vertices.

    Attributes:
        vertices: (V, 3) float64, each used by a tet.
        tets: (T, 4) int64, positive unless displacement inverted them.
        faces: (F, 3) int64, facing outward.
    """

    vertices: Float[np.ndarray, "V 3"]
    tets: Int[np.ndarray, "T 4"]
    faces: Int[np.ndarray, "F 3"]
