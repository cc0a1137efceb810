"""Finite elements of a solid, of degree 1 or 2, and named parts of their boundary."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.adjacency import EDGES, FACES, boundary_sides, unique_edges
from tetgan.geometry.tets import TetMesh

Groups = Mapping[str, Bool[np.ndarray, "F"]]
"""Of each name which boundary faces it has."""

MIDDLES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
"""Local ends of the edges with nodes 4 to 9 of degree 2 in their middles, as Abaqus and VTK number them."""

_SIDES = np.argmax((MIDDLES[:, None] == EDGES).all(axis=2), axis=1)  # the same edges in the order of `EDGES`


def _with_middles(face: Int[np.ndarray, "3"]) -> list[int]:
    """Local nodes of a face of degree 2: its corners, and behind each the middle of the edge it begins."""
    ends = np.sort(np.stack([face, np.roll(face, -1)], axis=1), axis=1)
    middles = [4 + int((end == MIDDLES).all(axis=1).argmax()) for end in ends]
    return [*face.tolist(), *middles]


_FACES = {1: FACES, 2: np.array([_with_middles(face) for face in FACES])}


@dataclass(frozen=True, eq=False)
class Elements:
    """A solid as solvers read it.

    Attributes:
        nodes: (N, 3), the vertices first.
        cells: (T, 4) nodes of each tet, its corners; or (T, 10), with the middles of its edges (`MIDDLES`).
        groups: of each name which of the boundary faces it has, in the order of `boundary_sides`.
    """

    nodes: Float[np.ndarray, "N 3"]
    cells: Int[np.ndarray, "T K"]
    groups: Groups = field(default_factory=dict)

    @property
    def order(self) -> int:
        """Degree of the elements."""
        return 1 if self.cells.shape[1] == 4 else 2

    @property
    def tets(self) -> Int[np.ndarray, "T 4"]:
        """Corners of the elements."""
        return self.cells[:, :4]

    @cached_property
    def sides(self) -> tuple[Int[np.ndarray, "F"], Int[np.ndarray, "F"]]:
        """Of each boundary face its element, and the local vertex opposite it."""
        return boundary_sides(self.tets)

    @cached_property
    def faces(self) -> Int[np.ndarray, "F M"]:
        """Nodes of the boundary faces, facing outward: three corners, and three middles in degree 2."""
        rows, slots = self.sides
        return np.take_along_axis(self.cells[rows], _FACES[self.order][slots], axis=1)

    def nodes_of(self, group: str) -> Int[np.ndarray, "M"]:
        """Nodes on the faces of a group, in order."""
        return np.unique(self.faces[self.groups[group]])

    def cells_of(self, group: str) -> Int[np.ndarray, "M"]:
        """Elements with a face in a group, in order."""
        return np.unique(self.sides[0][self.groups[group]])


def linear_elements(mesh: TetMesh, groups: Groups | None = None) -> Elements:
    """The tets as they are."""
    return Elements(mesh.vertices, mesh.tets, groups or {})


def quadratic_elements(mesh: TetMesh, groups: Groups | None = None) -> Elements:
    """The same tets with nodes at the middles of their straight edges."""
    edges, sides = unique_edges(mesh.tets)
    nodes = np.concatenate([mesh.vertices, mesh.vertices[edges].mean(axis=1)])
    cells = np.concatenate([mesh.tets, len(mesh.vertices) + sides[:, _SIDES]], axis=1)
    return Elements(nodes, cells, groups or {})


def scaled(elements: Elements, by: float) -> Elements:
    """The same elements, larger by a factor."""
    return replace(elements, nodes=by * elements.nodes)
