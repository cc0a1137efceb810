"""Move vertices towards targets while every tet stays positive and its angles bounded."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse

from tetgan.geometry.adjacency import unique_edges
from tetgan.geometry.tets import six_volumes, tet_shapes
from tetgan.meshing.collared_grid import CollaredGrid

_HALVINGS = 4  # a step is cut down to 1/16, then given up for the round

_RELAXATION = 0.7  # of the way to the mean of the neighbours, each time

_LEAST_VOLUME = 0.02  # of a tet's own volume on the grid: what it keeps, whatever moves

_RINGS = 2  # of vertices around the boundary that make way for it


class _Band(NamedTuple):
    """The part of space near the boundary, numbered for itself.

    Attributes:
        corners: (4, N) vertices of its tets; volume: (N,) six times the least volume of each.
        solid: whether each is occupied; cosine: of the least dihedral angle, which binds the occupied ones.
        used: (M,) its vertices in the collared grid.
        boundary, free: (M,) its vertices on the boundary, and the others that may move.
        averaging: (M, M) takes each free vertex to the mean of those it shares an edge with.
    """

    corners: Int[np.ndarray, "4 N"]
    volume: Float[np.ndarray, "N"]
    solid: Bool[np.ndarray, "N"]
    cosine: Float[np.ndarray, "N"]
    used: Int[np.ndarray, "M"]
    boundary: Bool[np.ndarray, "M"]
    free: Bool[np.ndarray, "M"]
    averaging: sparse.csr_array


def move_boundary(
    occupancy: Bool[np.ndarray, "T"],
    boundary: Int[np.ndarray, "B"],
    targets: Float[np.ndarray, "B 3"],
    ambient: CollaredGrid,
    *,
    min_dihedral: float,
    rounds: int,
) -> Float[np.ndarray, "V 3"]:
    """Positions of all vertices, those of the boundary as near to their targets as steps in turn bring them.

    A round steps every boundary vertex towards its target, then every other vertex nearby towards the mean of
    its neighbours, which makes room for the next round. A step that leaves any tet too small, or an occupied
    one with too small an angle, is halved for all vertices of that tet, until none is left: at worst nobody
    moves, and the grid itself is within the bounds.

    Args:
        boundary: vertices, ascending.
        min_dihedral: of occupied tets, in degrees; a tet that has less on the grid keeps what it has.
    """
    band = _band(occupancy, boundary, ambient, min_dihedral)
    positions = ambient.vertices.copy()
    here = positions[band.used].T.copy()
    goal = here.copy()
    goal[:, band.boundary] = targets[~ambient.pinned[boundary]].T
    for _ in range(rounds):
        here = _step(here, goal - here, band)
        mean = (band.averaging @ here.T).T
        here = _step(here, np.where(band.free, _RELAXATION * (mean - here), 0.0), band)
    here = _step(here, goal - here, band)
    positions[band.used] = here.T
    return positions


def _band(
    occupancy: Bool[np.ndarray, "T"],
    boundary: Int[np.ndarray, "B"],
    ambient: CollaredGrid,
    min_dihedral: float,
) -> _Band:
    movable = np.zeros(len(ambient.vertices), dtype=bool)
    movable[boundary] = True
    for _ in range(_RINGS):
        movable[ambient.tets[movable[ambient.tets].any(axis=1)]] = True
    movable &= ~ambient.pinned
    rows = np.flatnonzero(movable[ambient.tets].any(axis=1) & ambient.guarded)
    used, corners = np.unique(ambient.tets[rows], return_inverse=True)
    corners = np.ascontiguousarray(corners.reshape(-1, 4).T)
    own = tet_shapes(_points(ambient.vertices[used].T, corners))
    on_boundary = np.isin(used, boundary) & movable[used]
    solid = occupancy[rows]
    bound = np.cos(np.radians(min_dihedral)) - 1e-9
    return _Band(
        corners=corners,
        volume=_LEAST_VOLUME * own.volume,
        solid=solid,
        cosine=np.maximum(bound, own.cosine),
        used=used,
        boundary=on_boundary,
        free=movable[used] & ~on_boundary,
        averaging=_averaging(corners, len(used)),
    )


def _averaging(corners: Int[np.ndarray, "4 N"], vertices: int) -> sparse.csr_array:
    """(M, M): each vertex the mean of those it shares an edge with."""
    edges, _ = unique_edges(corners.T)
    ends, others = np.concatenate([edges, edges[:, ::-1]]).T
    weights = 1 / np.bincount(ends, minlength=vertices)
    return sparse.csr_array((weights[ends], (ends, others)), shape=(vertices, vertices))


def _step(
    here: Float[np.ndarray, "3 M"], step: Float[np.ndarray, "3 M"], band: _Band
) -> Float[np.ndarray, "3 M"]:
    """Here and as much of the step as leaves every tet of the band within its bounds."""
    halved = np.where((step != 0).any(axis=0), 0, _HALVINGS + 1)
    scale = (halved <= _HALVINGS).astype(np.float64)
    rows = np.flatnonzero((scale > 0)[band.corners].any(axis=0))
    while len(rows):
        wrong = rows[~_within_bounds(here + scale * step, band, rows)]
        touched = np.zeros(len(scale), dtype=bool)
        touched[band.corners[:, wrong]] = True
        touched &= scale > 0
        halved[touched] += 1
        scale[touched] = np.where(halved[touched] > _HALVINGS, 0.0, scale[touched] / 2)
        rows = np.flatnonzero(touched[band.corners].any(axis=0))
    return here + scale * step


def _within_bounds(
    here: Float[np.ndarray, "3 M"], band: _Band, rows: Int[np.ndarray, "R"]
) -> Bool[np.ndarray, "R"]:
    within = np.empty(len(rows), dtype=bool)
    solid = band.solid[rows]
    full, empty = rows[solid], rows[~solid]
    shapes = tet_shapes(_points(here, band.corners[:, full]))
    within[solid] = (shapes.volume >= band.volume[full]) & (shapes.cosine <= band.cosine[full])
    within[~solid] = six_volumes(_points(here, band.corners[:, empty])) >= band.volume[empty]
    return within


def _points(here: Float[np.ndarray, "3 M"], corners: Int[np.ndarray, "4 N"]) -> Float[np.ndarray, "4 3 N"]:
    return here.take(corners, axis=1).swapaxes(0, 1)
