"""From displacements at centroids to displacements at vertices."""

import numpy as np
from scipy import sparse

from tetgan.grids.grid import TetGrid


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
