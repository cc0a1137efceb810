"""Tetrahedral grid with its neighbours, edges, centroids and digest."""

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.adjacency import face_neighbors, unique_edges
from tetgan.geometry.tets import tet_volumes


@dataclass(frozen=True, eq=False)
class TetGrid:
    """Tetrahedra that share faces, every one positive: det(v1-v0, v2-v0, v3-v0) > 0.

    Attributes:
        vertices: (V, 3) float64, in the unit cube.
        tets: (T, 4) int64 vertex indices.
    """

    vertices: Float[np.ndarray, "V 3"]
    tets: Int[np.ndarray, "T 4"]

    @cached_property
    def centroids(self) -> Float[np.ndarray, "T 3"]:
        """Mean of the four vertices."""
        return self.vertices[self.tets].mean(axis=1)

    @cached_property
    def volumes(self) -> Float[np.ndarray, "T"]:
        """Signed volumes; all positive in a valid grid."""
        return tet_volumes(self.vertices, self.tets)

    @cached_property
    def neighbors(self) -> Int[np.ndarray, "T 4"]:
        """Slot s is the tet across the face opposite local vertex s; -1 outside the grid."""
        return face_neighbors(self.tets)

    @cached_property
    def edges(self) -> Int[np.ndarray, "E 2"]:
        """Every edge once, smaller vertex first."""
        return unique_edges(self.tets)[0]

    @cached_property
    def digest(self) -> str:
        """SHA-256 of vertices and tets, hexadecimal: equal exactly when the grids are."""
        sha = hashlib.sha256()
        for array, kind in ((self.vertices, "<f8"), (self.tets, "<i8")):
            sha.update(str(array.shape).encode())
            sha.update(array.astype(kind).tobytes())
        return sha.hexdigest()
