"""Occupancy and displacement of a shape on the tets of a grid."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Int
from scipy import sparse

from tetgan.grids.grid import TetGrid


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


def vertex_operator(grid: TetGrid) -> sparse.csr_array:
    """Eq. 3: each vertex averages its incident tets, weighted by the inverse distance to their centroids.

    Returns:
        (V, T) float64; `vertex_operator(grid) @ displacement` is (V, 3). A row sums to 1, or is empty where
        no tet uses the vertex.
    """
    rows = grid.tets.ravel()
    distances = np.linalg.norm(grid.vertices[grid.tets] - grid.centroids[:, None], axis=-1)
    weights = 1 / distances.ravel()
    weights /= np.bincount(rows, weights, minlength=len(grid.vertices))[rows]
    columns = np.arange(rows.size) // 4
    return sparse.csr_array((weights, (rows, columns)), shape=(len(grid.vertices), len(grid.tets)))
