"""Edges, vertex fans and shells of a triangle surface, and whether it is a closed manifold."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.adjacency import unique_edges
from tetgan.geometry.components import label_components
from tetgan.geometry.triangles import six_cones

_SIDES = np.array([[0, 1], [0, 2], [1, 2]])  # as `unique_edges` lists them

_OPPOSITE = np.array([2, 1, 0])


@dataclass(frozen=True, eq=False)
class Boundary:
    """Faces that turn counter-clockwise seen from outside, with counts of their defects.

    A fan is a closed ring of faces around a vertex, each joined to the next by an edge of two faces.
    """

    faces: Int[np.ndarray, "F 3"]

    @cached_property
    def _edges(self) -> tuple[Int[np.ndarray, "E 2"], Int[np.ndarray, "S"]]:
        """The edges, and the edge of each of the 3F sides."""
        edges, edge_of_side = unique_edges(self.faces)
        return edges, edge_of_side.ravel()

    @cached_property
    def _faces_of_edge(self) -> Int[np.ndarray, "E"]:
        edges, edge_of_side = self._edges
        return np.bincount(edge_of_side, minlength=len(edges))

    @cached_property
    def _runs_upward(self) -> Bool[np.ndarray, "S"]:
        """Whether a face runs along its side from the smaller vertex to the larger."""
        listed = self.faces[:, _SIDES]
        upward = listed[:, :, 0] < listed[:, :, 1]
        upward[:, 1] ^= True  # the side 02 is run through from 2 to 0
        return upward.ravel()

    @cached_property
    def _pairs(self) -> Int[np.ndarray, "P 2"]:
        """The two sides of every edge of two faces."""
        _, edge_of_side = self._edges
        order = np.argsort(edge_of_side, kind="stable")
        return order[self._faces_of_edge[edge_of_side[order]] == 2].reshape(-1, 2)

    @property
    def manifold_edges(self) -> float:
        """Share of the edges with exactly two faces; 0 without edges."""
        return float((self._faces_of_edge == 2).mean()) if len(self.faces) else 0.0

    @property
    def nonmanifold_edges(self) -> int:
        """Edges with one face, or with more than two."""
        return int((self._faces_of_edge != 2).sum())

    @property
    def misoriented_edges(self) -> int:
        """Edges whose two faces both run along them in the same direction."""
        one, other = self._runs_upward[self._pairs].T
        return int((one == other).sum())

    @cached_property
    def nonmanifold_vertices(self) -> int:
        """Vertices whose faces are not exactly one fan."""
        if len(self.faces) == 0:
            return 0
        corners = 3 * np.arange(len(self.faces))[:, None, None] + _SIDES
        rises = self.faces[:, _SIDES[:, 0]] < self.faces[:, _SIDES[:, 1]]
        lower = np.where(rises, corners[..., 0], corners[..., 1]).ravel()
        upper = np.where(rises, corners[..., 1], corners[..., 0]).ravel()
        one, other = self._pairs.T
        here, there = (np.concatenate([lower[side], upper[side]]) for side in (one, other))
        fan_of_corner = label_components(here, there, self.faces.size)
        vertex_of_fan = np.zeros(fan_of_corner.max() + 1, dtype=np.int64)
        vertex_of_fan[fan_of_corner] = self.faces.ravel()
        fans = np.bincount(vertex_of_fan)
        edges, _ = self._edges
        fans[edges[self._faces_of_edge != 2].ravel()] = 2  # open fans count as several
        return int((fans > 1).sum())

    def shells(self, vertices: Float[np.ndarray, "V 3"]) -> Int[np.ndarray, "F"]:
        """Number of the closed surface that each face belongs to.

        Faces belong together where one reaches the other over edges without entering the solid. Where more
        than two faces meet at an edge, the next one counter-clockwise lies across the empty wedge outside of
        each. So a shell is what encloses one void, or the solid's outside, as far as that can be reached
        without passing a point.
        """
        one, other = np.concatenate([self._pairs // 3, self._wedges(vertices)]).T
        return label_components(one, other, len(self.faces))

    def _wedges(self, vertices: Float[np.ndarray, "V 3"]) -> Int[np.ndarray, "N 2"]:
        """Faces on both sides of the empty wedges at edges of more than two faces."""
        edges, edge_of_side = self._edges
        sides = np.flatnonzero(self._faces_of_edge[edge_of_side] > 2)
        if len(sides) == 0:
            return np.empty((0, 2), dtype=np.int64)
        edge = edge_of_side[sides]
        opposite = vertices[self.faces[sides // 3, _OPPOSITE[sides % 3]]]
        start, end = np.moveaxis(vertices[edges[edge]], 1, 0)
        _, first, place = np.unique(edge, return_index=True, return_inverse=True)
        angle = _angles_around(start, end, opposite, opposite[first[place]])
        order = np.lexsort((angle, edge))
        begins = np.flatnonzero(np.r_[True, np.diff(edge[order]) > 0])
        following = np.arange(1, len(order) + 1)
        following[np.r_[begins[1:], len(order)] - 1] = begins
        faces, outside_ahead = sides[order] // 3, self._runs_upward[sides[order]]
        return np.stack([faces, faces[following]], axis=1)[outside_ahead]


def shell_volumes(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], shell: Int[np.ndarray, "F"]
) -> Float[np.ndarray, "S"]:
    """Signed volume that each shell encloses, negative for a void."""
    if len(faces) == 0:
        return np.empty(0)
    corners = vertices[faces]
    return np.bincount(shell, weights=six_cones(corners, corners.mean(axis=(0, 1)))) / 6


def _angles_around(
    start: Float[np.ndarray, "N 3"],
    end: Float[np.ndarray, "N 3"],
    point: Float[np.ndarray, "N 3"],
    zero: Float[np.ndarray, "N 3"],
) -> Float[np.ndarray, "N"]:
    """Angles of points around an axis, from `zero`, counter-clockwise seen against its direction."""
    axis = end - start
    right = np.cross(axis, zero - start)
    length = np.linalg.norm(axis, axis=1)
    # Across the axis: `ahead` towards zero and `right` a quarter turn on, both of the same length.
    ahead = np.cross(right, axis) / np.maximum(length, np.finfo(float).tiny)[:, None]
    return np.arctan2(((point - start) * right).sum(axis=1), ((point - start) * ahead).sum(axis=1))
