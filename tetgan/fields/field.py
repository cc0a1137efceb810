"""A shape as two fields on the tets of a grid."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Int


@dataclass(frozen=True, eq=False)
class Field:
    """The paper's X = [O, D] of one shape.

    Attributes:
        occupancy: (T,) whether the centroid lies inside.
        displacement: (T, 3) from the centroid to the closest point of the surface, in cube sides.
    """

    occupancy: Bool[np.ndarray, "T"]
    displacement: Float32[np.ndarray, "T 3"]


@dataclass(frozen=True, eq=False)
class VertexField:
    """A shape whose displacements are known at vertices alone, as a network of its surface predicts them.

    Attributes:
        occupancy: (T,) whether the centroid lies inside.
        vertex_displacement: (V, 3) in cube sides; that of vertices off the boundary means nothing.
    """

    occupancy: Bool[np.ndarray, "T"]
    vertex_displacement: Float32[np.ndarray, "V 3"]


def surface_tets(
    occupancy: Bool[np.ndarray, "T"], neighbors: Int[np.ndarray, "T 4"]
) -> Bool[np.ndarray, "T"]:
    """Occupied tets with a face on the surface; beyond the wall of the cube nothing is occupied."""
    padded = np.append(occupancy, False)  # the -1 of a missing neighbour reads this last entry
    return occupancy & ~padded[neighbors].all(axis=1)
