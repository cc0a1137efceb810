"""Grid of the cube with a collar of tets around it that is never occupied."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.adjacency import EDGES, boundary_faces, unique_edges
from tetgan.geometry.tets import TetMesh, tet_volumes
from tetgan.grids.grid import TetGrid
from tetgan.meshing.stars import Stars

VERTEX_FACES = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])
"""For each corner of a tet the slots of the three faces that hold it."""


# How far outside the grid the collar ends: the wall is scaled about the middle of the grid by this factor.
_COLLAR = 1.25


# A prism over the wall, its three outer corners numbered 3, 4, 5, as tets that are positive where corners
# 0, 1, 2 turn counter-clockwise seen from outside. Every side of it is cut from its lower inner corner, so
# prisms side by side agree wherever all corners are in the order of their indices.
_PRISM = np.array([[0, 1, 2, 5], [0, 1, 5, 4], [0, 3, 4, 5]])


@dataclass(frozen=True, eq=False)
class CollaredGrid(TetMesh):
    """A grid and its collar: a triangulated ball, of which a solid occupies tets of the grid.

    Around every vertex of the grid the tets close up to a ball, at the wall too, so topology needs no special
    case there, and vertices at the wall may move as the others do: only the outside of the collar is fixed.

    Attributes:
        vertices: (V, 3), those of the grid first.
        tets: (T, 4), those of the grid first, in its order.
        grid_tets: number of tets of the grid.
        pinned: (V,) vertices that never move: the outside of the collar.
        guarded: (T,) tets that stay positive: all, unless the grid is not star-shaped seen from its middle.
            Then the collar has no such geometry, and the wall is pinned instead.
    """

    grid_tets: int
    pinned: Bool[np.ndarray, "V"]
    guarded: Bool[np.ndarray, "T"]

    @cached_property
    def around_vertices(self) -> Stars:
        """The tets around each vertex, joined by the faces that hold it."""
        return Stars(self.tets, self.neighbors, VERTEX_FACES)

    @cached_property
    def around_edges(self) -> Stars:
        """The tets around each edge, joined by the faces that hold it; edges are numbered as in `edges`."""
        return Stars(self.edges_of_tets, self.neighbors, EDGES[::-1])

    @cached_property
    def edges_of_tets(self) -> Int[np.ndarray, "T 6"]:
        """The edges of each tet, by their number in `edges`."""
        return self._unique_edges[1]

    @cached_property
    def edges(self) -> Int[np.ndarray, "E 2"]:
        """Every edge once, smaller vertex first."""
        return self._unique_edges[0]

    @cached_property
    def _unique_edges(self) -> tuple[Int[np.ndarray, "E 2"], Int[np.ndarray, "T 6"]]:
        return unique_edges(self.tets)

    def corners(self, tets: Int[np.ndarray, "N"]) -> Float[np.ndarray, "4 3 N"]:
        """Corners of some tets, coordinate by coordinate: much the fastest layout."""
        return self.vertices.T[:, self.tets[tets].T].swapaxes(0, 1)

    def with_collar(self, occupancy: Bool[np.ndarray, "N"]) -> Bool[np.ndarray, "T"]:
        """Occupancy of the grid, and behind it that of the collar, which is empty."""
        return np.concatenate([occupancy, np.zeros(len(self.tets) - self.grid_tets, dtype=bool)])


@lru_cache(maxsize=2)
def collared_grid(grid: TetGrid) -> CollaredGrid:
    """The grid in its collar; made once a grid."""
    faces = boundary_faces(grid.tets)
    wall = np.unique(faces)
    middle = (grid.vertices.min(axis=0) + grid.vertices.max(axis=0)) / 2
    vertices = np.concatenate([grid.vertices, middle + _COLLAR * (grid.vertices[wall] - middle)])
    collar = _prism_tets(faces, np.searchsorted(wall, faces) + len(grid.vertices))
    pinned = np.arange(len(vertices)) >= len(grid.vertices)
    guarded = np.ones(len(grid.tets) + len(collar), dtype=bool)
    if not (tet_volumes(vertices, collar) > 0).all():
        pinned[wall], guarded[len(grid.tets) :] = True, False
    return CollaredGrid(vertices, np.concatenate([grid.tets, collar]), len(grid.tets), pinned, guarded)


def _prism_tets(inner: Int[np.ndarray, "F 3"], outer: Int[np.ndarray, "F 3"]) -> Int[np.ndarray, "C 4"]:
    """Three positive tets between each face, seen from outside, and its copy outside it."""
    order = np.argsort(inner, axis=1)
    corners = np.take_along_axis(
        np.concatenate([inner, outer], axis=1), np.hstack([order, order + 3]), axis=1
    )
    tets = corners[:, _PRISM]
    mirrored = np.linalg.det(np.eye(3)[order]) < 0
    tets[mirrored] = tets[mirrored][..., [0, 1, 3, 2]]
    return tets.reshape(-1, 4)
