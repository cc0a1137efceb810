"""From what the tets of a field know of a surface to a solid bounded by it."""

from dataclasses import replace
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.adjacency import boundary_faces, unique_edges
from tetgan.geometry.components import connect_tets
from tetgan.geometry.tets import tet_volumes
from tetgan.grids.graded import GradedGrid
from tetgan.meshing.cutting import cut_tets
from tetgan.meshing.relaxation import Bounds, Projection, Space, bounds_of, relax, step_within
from tetgan.meshing.smoothing import smooth_vertices
from tetgan.meshing.snapping import snap_vertices
from tetgan.solids.solid import SolidChanges, SolidMesh

_DRAWN = 0.75  # of an edge: a vertex as near to where the surface crosses it may be drawn there

_HELD = 0.1  # of a cell: vertices of the surface further from it count as held back


@runtime_checkable
class Surface(Protocol):
    """A surface as the signed distance from it, negative inside."""

    def distance(self, points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N"]: ...

    def distance_and_normal(
        self, points: Float[np.ndarray, "N 3"]
    ) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N 3"]]: ...

    def projection(self, points: Float[np.ndarray, "N 3"], reach: float) -> Projection: ...


class Fit(NamedTuple):
    """How a surface is met: the least dihedral angle in degrees, rounds of relaxation, smoothing (Eq. 4).

    Without a `beta` nothing is smoothed.
    """

    min_dihedral: float
    rounds: int
    beta: float | None = None


def cut_solid(
    grid: GradedGrid, distances: Float[np.ndarray, "V"], surface: Surface, cell: float, fit: Fit
) -> SolidMesh:
    """The part of a lattice within a surface, as tets with a manifold boundary on it.

    1. Where the distance, linearly interpolated, changes its sign, tets are cut (`cut_tets`), with nodes
       halfway along their edges; lattice vertices near the surface are first taken to lie on it, where its
       topology allows (`snap_vertices`). The boundary is a manifold by that alone, and no dihedral angle is
       below 25.3 degrees.
    2. Vertices go to the surface and into better tets as far as every tet allows (`relax`), on both sides:
       the piecewise linear map of the lattice stays injective, so the boundary cannot meet itself.

    Args:
        grid: where distances change their sign, and two rings of vertices around, finest and not green.
        distances: of the vertices, none zero; those on the hull are positive.
        cell: length of a side of the finest cells.

    Returns:
        The solid; without tets where no distance is negative.
    """
    signs = np.where(distances < 0, -1, 1)
    if not (signs < 0).any():
        return SolidMesh.empty()
    makes_way, near = around_crossings(grid.tets, distances)
    candidates, away = _nearest(*_beside_crossings(grid, grid.tets[near], distances))
    signs = snap_vertices(grid.tets[near], signs, candidates, away)
    cut = cut_tets(grid.tets[near], signs, grid.points)
    nodes = _where_zero(grid, cut.edges, distances)
    points = np.concatenate([grid.vertices, grid.vertices[cut.edges].mean(axis=1)])
    inside, outside = _positive(points, cut.inside), _positive(points, cut.outside)
    used, corners = np.unique(np.concatenate([inside, outside]), return_inverse=True)
    lattice = used < len(signs)
    on_surface = ~lattice
    on_surface[lattice] = signs[used[lattice]] == 0
    space = Space(
        corners=np.ascontiguousarray(corners.reshape(-1, 4).T),
        inside=np.arange(corners.size // 4) < len(inside),
        surface=on_surface,
        free=np.isin(used, np.flatnonzero(makes_way)) & ~on_surface,
    )

    targets = np.concatenate([grid.vertices, nodes])[used]
    project = surface.projection(targets[on_surface], cell / 2)
    targets[on_surface] = np.where(
        lattice[on_surface, None], project(targets[on_surface]), targets[on_surface]
    )
    bounds = bounds_of(points[used], space, fit.min_dihedral)
    moved = relax(points[used], targets, project, space, bounds, cell=cell, rounds=fit.rounds)
    if fit.beta is not None:
        moved = _smooth(moved, space, surface, bounds, fit.beta)
    points[used] = moved
    held = np.abs(surface.distance(moved[on_surface])) > _HELD * cell
    deep = grid.tets[~near]
    deep = deep[(signs[deep] < 0).all(axis=1)]
    changes = SolidChanges(snapped=int((signs == 0).sum()), held=int(held.sum()))
    return _solid(points, np.concatenate([inside, deep]), changes)


def drop_small_pieces(mesh: SolidMesh, smallest: float) -> SolidMesh:
    """The solid without its pieces of less than a share of its volume; the largest stays in any case."""
    if not len(mesh.tets):
        return mesh
    component = connect_tets(mesh.tets).component
    volumes = np.bincount(component, mesh.volumes)
    shares = volumes / volumes.sum()
    dropped = shares < min(smallest, shares.max())
    if not dropped.any():
        return mesh
    changes = replace(mesh.changes, dropped=tuple(shares[dropped].tolist()))
    return _solid(mesh.vertices, mesh.tets[~dropped[component]], changes)


def _solid(
    points: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"], changes: SolidChanges
) -> SolidMesh:
    used, corners = np.unique(tets, return_inverse=True)
    tets = corners.reshape(-1, 4)
    return SolidMesh(points[used], tets, boundary_faces(tets), changes)


def around_crossings(
    tets: Int[np.ndarray, "T 4"], distances: Float[np.ndarray, "V"]
) -> tuple[Bool[np.ndarray, "V"], Bool[np.ndarray, "T"]]:
    """Vertices that make way for a surface, and all tets that have one of them.

    They are those of tets in which the distance changes its sign, and one ring more.
    """
    near = np.zeros(len(distances), dtype=bool)
    near[tets[_crossed(tets, distances)]] = True
    near[tets[near[tets].any(axis=1)]] = True
    return near, near[tets].any(axis=1)


def _crossed(tets: Int[np.ndarray, "T 4"], distances: Float[np.ndarray, "V"]) -> Bool[np.ndarray, "T"]:
    negative = (distances < 0)[tets].sum(axis=1)
    return (negative > 0) & (negative < 4)


def _where_zero(
    grid: GradedGrid, edges: Int[np.ndarray, "E 2"], distances: Float[np.ndarray, "V"]
) -> Float[np.ndarray, "E 3"]:
    """Where the distance is zero along edges whose ends differ in sign."""
    one, other = distances[edges].T
    share = (one / (one - other))[:, None]
    return (1 - share) * grid.vertices[edges[:, 0]] + share * grid.vertices[edges[:, 1]]


def _beside_crossings(
    grid: GradedGrid, tets: Int[np.ndarray, "T 4"], distances: Float[np.ndarray, "V"]
) -> tuple[Int[np.ndarray, "N"], Float[np.ndarray, "N"]]:
    """Ends of edges that the surface crosses, where it is near enough to draw them, and how near it is."""
    edges, _ = unique_edges(tets[_crossed(tets, distances)])
    edges = edges[(distances[edges] < 0).sum(axis=1) == 1]
    places = _where_zero(grid, edges, distances)
    apart = np.linalg.norm(grid.vertices[edges] - places[:, None], axis=2)
    near = apart <= _DRAWN * apart.sum(axis=1, keepdims=True)
    return edges[near], apart[near]


def _nearest(
    vertices: Int[np.ndarray, "N"], distances: Float[np.ndarray, "N"]
) -> tuple[Int[np.ndarray, "M"], Float[np.ndarray, "M"]]:
    """Each vertex once, with the least of its distances."""
    order = np.lexsort([distances, vertices])
    found, first = np.unique(vertices[order], return_index=True)
    return found, distances[order][first]


def _positive(points: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "T 4"]:
    """The same tets, all positive."""
    return np.where((tet_volumes(points, tets) > 0)[:, None], tets, tets[:, [0, 1, 3, 2]])


def _smooth(
    points: Float[np.ndarray, "M 3"], space: Space, surface: Surface, bounds: Bounds, beta: float
) -> Float[np.ndarray, "M 3"]:
    """One step of Eq. 4, as far as every tet allows; displacements have the directions of normals."""
    normals = np.zeros_like(points)
    normals[space.surface] = surface.distance_and_normal(points[space.surface])[1]
    faces = boundary_faces(space.corners[:, space.inside].T)
    goal = smooth_vertices(points, normals, faces[space.surface[faces].all(axis=1)], beta)
    return step_within(points.T, goal.T - points.T, space, bounds).T
