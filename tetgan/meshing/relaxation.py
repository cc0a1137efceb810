"""Move the vertices of a cut lattice to the surface and into better tets, within bounds on every tet."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.adjacency import EDGES
from tetgan.geometry.tets import six_volumes, tet_shapes

Projection = Callable[[Float[np.ndarray, "N 3"]], Float[np.ndarray, "N 3"]]
"""Points near a surface to points on it."""

_HALVINGS = 5  # a step is cut down to 1/32, then given up for the round

_LEAST_VOLUME = 0.02  # of a tet's own volume at first: what it keeps, whatever moves

_LONGEST_STEP = 0.25  # of a cell, towards better tets in one round

_REGULAR = 6**1.5 * np.sqrt(2)  # (sum of squared edges)^1.5 over six times the volume, of a regular tet


class Space(NamedTuple):
    """Tets of both sides around a surface, in which some vertices move.

    Attributes:
        corners: (4, N) vertices of the tets, among them all tets of the vertices that move.
        inside: (N,) tets of the solid.
        surface: (M,) vertices that belong on the surface; free: (M,) further ones that move.
    """

    corners: Int[np.ndarray, "4 N"]
    inside: Bool[np.ndarray, "N"]
    surface: Bool[np.ndarray, "M"]
    free: Bool[np.ndarray, "M"]


class Bounds(NamedTuple):
    """What every tet keeps: six times a volume (N,); those of the solid, the cosine of an angle too."""

    volume: Float[np.ndarray, "N"]
    cosine: float


def bounds_of(points: Float[np.ndarray, "M 3"], space: Space, min_dihedral: float) -> Bounds:
    """The bounds that hold for a space from here on.

    Args:
        min_dihedral: of tets of the solid, in degrees; all have it here.
    """
    volume = six_volumes(_corner_points(points.T, space.corners))
    return Bounds(_LEAST_VOLUME * volume, float(np.cos(np.radians(min_dihedral)) + 1e-12))


def relax(
    points: Float[np.ndarray, "M 3"],
    targets: Float[np.ndarray, "M 3"],
    project: Projection,
    space: Space,
    bounds: Bounds,
    *,
    cell: float,
    rounds: int,
) -> Float[np.ndarray, "M 3"]:
    """Vertices of the surface to their targets, then all to better tets, those of the surface along it.

    A round steps down the gradient of the sum, over tets of the solid, of
    q = (sum of squared edges)^1.5 / volume, which is least for regular tets and infinite for flat ones, and
    puts the vertices of the surface back onto it. A step that leaves any tet beyond its bounds is halved for
    all vertices of that tet, until none is left: at worst nobody moves. So all bounds hold in the end that
    held at first, and no tet has turned over.

    Args:
        targets: where the surface is first looked for; those of other vertices are not used.
        cell: length of a side of the lattice's cells.
    """
    here, surface = points.T.copy(), np.flatnonzero(space.surface)
    here = step_within(here, np.where(space.surface, targets.T - here, 0.0), space, bounds)
    moving = space.surface | space.free
    for number in range(rounds + 1):
        goal = here.copy()
        if number < rounds:
            goal += np.where(moving, _downhill(here, space, cell), 0.0)
        goal[:, surface] = project(goal[:, surface].T).T
        here = step_within(here, goal - here, space, bounds)
    return here.T.copy()


def step_within(
    here: Float[np.ndarray, "3 M"], step: Float[np.ndarray, "3 M"], space: Space, bounds: Bounds
) -> Float[np.ndarray, "3 M"]:
    """Here and as much of the step as leaves every tet within its bounds."""
    halved = np.where((step != 0).any(axis=0), 0, _HALVINGS + 1)
    scale = (halved <= _HALVINGS).astype(np.float64)
    rows = np.flatnonzero((scale > 0)[space.corners].any(axis=0))
    while len(rows):
        wrong = rows[~_within(here + scale * step, space, bounds, rows)]
        touched = np.zeros(len(scale), dtype=bool)
        touched[space.corners[:, wrong]] = True
        touched &= scale > 0
        halved[touched] += 1
        scale[touched] = np.where(halved[touched] > _HALVINGS, 0.0, scale[touched] / 2)
        rows = np.flatnonzero(touched[space.corners].any(axis=0))
    return here + scale * step


def _within(
    here: Float[np.ndarray, "3 M"], space: Space, bounds: Bounds, rows: Int[np.ndarray, "R"]
) -> Bool[np.ndarray, "R"]:
    within, solid = np.empty(len(rows), dtype=bool), space.inside[rows]
    full, empty = rows[solid], rows[~solid]
    shapes = tet_shapes(_corner_points(here, space.corners[:, full]))
    within[solid] = (shapes.volume >= bounds.volume[full]) & (shapes.cosine <= bounds.cosine)
    within[~solid] = six_volumes(_corner_points(here, space.corners[:, empty])) >= bounds.volume[empty]
    return within


def _downhill(here: Float[np.ndarray, "3 M"], space: Space, cell: float) -> Float[np.ndarray, "3 M"]:
    """Steps down the gradient of the sum of q, about as long as Newton's would be."""
    gradient, curvature = shape_gradient(here, space.corners[:, space.inside])
    step = -gradient / np.maximum(curvature, np.finfo(float).tiny)
    length = np.sqrt((step**2).sum(axis=0))
    return step * np.minimum(1.0, _LONGEST_STEP * cell / np.maximum(length, np.finfo(float).tiny))


def shape_gradient(
    here: Float[np.ndarray, "3 M"], corners: Int[np.ndarray, "4 N"]
) -> tuple[Float[np.ndarray, "3 M"], Float[np.ndarray, "M"]]:
    """Gradient by each vertex of the sum of q over tets, and a rough size of its second derivative.

    With S the sum of squared edges and V six times the volume, q = S^1.5 / V, over what a regular tet has.
    """
    points = _corner_points(here, corners)
    a, b, c = points[1:] - points[:1]
    one, two, three = _cross(b, c), _cross(c, a), _cross(a, b)
    volume = (a * one).sum(axis=0)
    by_volume = np.stack([-(one + two + three), one, two, three])
    squares = np.zeros(points.shape[2])
    for i, j in EDGES:
        squares += ((points[i] - points[j]) ** 2).sum(axis=0)
    by_squares = 2 * (4 * points - points.sum(axis=0))
    energy = squares**1.5 / (_REGULAR * volume)
    slopes = energy * (1.5 * by_squares / squares - by_volume / volume)
    flat, count = corners.ravel(), here.shape[1]
    gradient = np.stack([np.bincount(flat, slopes[:, axis].ravel(), minlength=count) for axis in range(3)])
    bend = np.tile(energy * 36 / squares, 4)
    return gradient, np.bincount(flat, bend, minlength=count)


def _cross(a: Float[np.ndarray, "3 N"], b: Float[np.ndarray, "3 N"]) -> Float[np.ndarray, "3 N"]:
    return np.cross(a, b, axis=0)


def _corner_points(
    here: Float[np.ndarray, "3 M"], corners: Int[np.ndarray, "4 N"]
) -> Float[np.ndarray, "4 3 N"]:
    return here.take(corners, axis=1).swapaxes(0, 1)
