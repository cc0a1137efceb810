"""Positions to which a vertex can be pulled into a patch, with all tets positive and angles bounded."""

from collections.abc import Callable
from functools import partial

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.adjacency import FACES
from tetgan.geometry.tets import tet_shapes
from tetgan.meshing.collared_grid import CollaredGrid
from tetgan.meshing.patches import Patches

# Shares of the way at the end of which a tet of the patch would be flat: the first that will do is taken. A
# gap is to be narrow, and a seam thick enough for its angles.
_GAPS = np.array([1 / 4, 1 / 8, 1 / 16])

_SEAMS = np.array([1 / 4, 3 / 8, 1 / 2])


# Steps around the best of these, in the same unit, each to the best of six sides, while that is better.
_SEARCH = (0.2, 0.2, 0.1, 0.1, 0.05, 0.05)

_SIDES = np.concatenate([np.eye(3), -np.eye(3)])

_TURNS = 30  # towards the direction furthest within the rim

_NEVER = 2.0  # instead of a cosine: a tet is too small


def places_to_pull_to(
    patches: Patches, space: CollaredGrid, min_dihedral: float, least_volume: float
) -> tuple[Float[np.ndarray, "P 3"], Bool[np.ndarray, "P"]]:
    """For each patch a place for its copy of the vertex, and whether there is one.

    The patch's tets move their corner there, and on each side of the rim a tet of the other kind is made,
    between the vertex and its copy. The place is sought in the direction that is furthest within all faces
    of the rim; for a seam, whose tets are to have good angles, then around there too.

    Args:
        min_dihedral: of occupied tets, in degrees; one that has less keeps what it has.
        least_volume: six times that of any tet.
    """
    direction, inward = _most_inward(patches, space)
    reach, bound = _reach(patches, direction, space), _bounds(patches, space, min_dihedral)
    share = np.where(patches.occupied, _GAPS[:, None], _SEAMS[:, None])
    trials = space.vertices[patches.vertex] + (share * reach)[..., None] * direction
    judge = partial(_worst_angles, space=space, least_volume=least_volume)
    worst = judge(patches, trials)
    good = (worst <= bound).any(axis=0)
    place, worst = _pick(trials, worst, np.where(good, (worst <= bound).argmax(axis=0), worst.argmin(axis=0)))
    unsure = inward & ~good & ~patches.occupied & (worst < _NEVER)
    place[unsure], worst[unsure] = _search(
        patches.only(unsure), place[unsure], worst[unsure], reach[unsure], judge
    )
    return place, inward & (worst <= bound)


def made_tets(
    patches: Patches, places: Float[np.ndarray, "K P 3"], space: CollaredGrid
) -> Float[np.ndarray, "4 3 K N"]:
    """Corners of the tets between the vertices and their copies, for each choice of places."""
    return _replaced(space, patches.rim_tets, patches.rim_slot, places[:, patches.rim_patch])


def _pick(
    trials: Float[np.ndarray, "K P 3"], worst: Float[np.ndarray, "K P"], which: Int[np.ndarray, "P"]
) -> tuple[Float[np.ndarray, "P 3"], Float[np.ndarray, "P"]]:
    every = np.arange(len(which))
    return trials[which, every], worst[which, every]


def _search(
    patches: Patches,
    place: Float[np.ndarray, "P 3"],
    worst: Float[np.ndarray, "P"],
    reach: Float[np.ndarray, "P"],
    judge: Callable[[Patches, Float[np.ndarray, "K P 3"]], Float[np.ndarray, "K P"]],
) -> tuple[Float[np.ndarray, "P 3"], Float[np.ndarray, "P"]]:
    """Places nearby where the worst angle is better, and that angle."""
    for size in _SEARCH if len(place) else ():
        trials = np.concatenate([place[None], place + size * reach[:, None] * _SIDES[:, None]])
        angles = np.concatenate([worst[None], judge(patches, trials[1:])])
        place, worst = _pick(trials, angles, angles.argmin(axis=0))
    return place, worst


def _most_inward(
    patches: Patches, space: CollaredGrid
) -> tuple[Float[np.ndarray, "P 3"], Bool[np.ndarray, "P"]]:
    """The direction of the largest least angle with the faces of each rim, and whether it is within all.

    It is that of the shortest vector in the convex hull of their normals, which is sought from their mean by
    turning to the normal that is least ahead (Frank and Wolfe 1956; Gilbert 1966).
    """
    normals = _inward_normals(space.vertices, space.tets[patches.rim_tets], patches.rim_slot)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shortest = np.zeros((len(patches.vertex), 3))
    for turn in range(_TURNS):
        ahead = np.einsum("nc,nc->n", normals, shortest[patches.rim_patch])
        last = np.flatnonzero(-ahead == patches.most_of_rim(-ahead)[patches.rim_patch])
        where = patches.rim_patch[last]
        shortest[where] += (normals[last] - shortest[where]) / (turn + 1)
    length = np.linalg.norm(shortest, axis=1, keepdims=True)
    direction = shortest / np.maximum(length, np.finfo(float).tiny)
    behind = -np.einsum("nc,nc->n", normals, direction[patches.rim_patch])
    return direction, patches.most_of_rim(behind) < 0


def _inward_normals(
    vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "N 4"], slot: Int[np.ndarray, "N"]
) -> Float[np.ndarray, "N 3"]:
    """Normal of the face opposite a corner of each tet, towards that corner, as long as twice its area."""
    a, b, c = np.moveaxis(vertices[np.take_along_axis(tets, FACES[slot], axis=1)], 1, 0)
    return np.cross(c - a, b - a)


def _reach(
    patches: Patches, direction: Float[np.ndarray, "P 3"], space: CollaredGrid
) -> Float[np.ndarray, "P"]:
    """How far the vertex can go until the first tet of its patch is flat; 0 where none ever is."""
    tets = space.tets[patches.tets]
    normals = _inward_normals(space.vertices, tets, patches.corner)
    loss = (
        -np.einsum("nc,nc->n", normals, direction[patches.patch])
        / tet_shapes(space.corners(patches.tets)).volume
    )
    most = patches.most_of_tets(loss)
    return np.divide(1, most, out=np.zeros_like(most), where=most > 0)


def _bounds(patches: Patches, space: CollaredGrid, min_dihedral: float) -> Float[np.ndarray, "P"]:
    """The largest cosine that an angle of each patch may have."""
    own = tet_shapes(space.corners(patches.tets)).cosine
    kept = np.where(patches.occupied[patches.patch], own, -1.0)
    return np.maximum(patches.most_of_tets(kept), np.cos(np.radians(min_dihedral)) - 1e-9)


def _worst_angles(
    patches: Patches, places: Float[np.ndarray, "K P 3"], space: CollaredGrid, least_volume: float
) -> Float[np.ndarray, "K P"]:
    """Cosine of the least angle of the occupied tets moved or made; `_NEVER` where any tet is too small."""
    moved = tet_shapes(_replaced(space, patches.tets, patches.corner, places[:, patches.patch]))
    made = tet_shapes(made_tets(patches, places, space))
    occupied = patches.occupied[patches.patch], ~patches.occupied[patches.rim_patch]
    cosines = (
        np.where(shapes.volume < least_volume, _NEVER, np.where(solid, shapes.cosine, -1.0))
        for shapes, solid in zip((moved, made), occupied, strict=True)
    )
    return np.maximum(patches.most_of_tets(next(cosines)), patches.most_of_rim(next(cosines)))


def _replaced(
    space: CollaredGrid,
    tets: Int[np.ndarray, "N"],
    slot: Int[np.ndarray, "N"],
    points: Float[np.ndarray, "K N 3"],
) -> Float[np.ndarray, "4 3 K N"]:
    """Corners of some tets, with other points for one of each."""
    corners = np.repeat(space.corners(tets)[:, :, None], len(points), axis=2)
    corners[slot, :, :, np.arange(len(tets))] = np.moveaxis(points, 1, 0).swapaxes(1, 2)
    return corners
