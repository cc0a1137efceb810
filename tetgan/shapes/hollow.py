"""Find and fill rooms that a repair left hollow, where an open sheet became a thin shell.

A vase with a thick wall is open, and stays so; a sofa whose underside was never modelled, a car of single
sheets with a gap in its floor, are hollow. Two shares of the directions around a point tell them apart: those
in which it meets a wall at all, and those in which that wall is a sheet, too thin for a grid to hold.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from tetgan.geometry.components import label_components
from tetgan.geometry.inside import is_inside
from tetgan.geometry.rays import Visibility, spread_directions
from tetgan.geometry.triangles import TriangleMesh

_CELLS = 40  # voxels along the longest side: insides of one or two voxels (5 %) are too small to matter

_DIRECTIONS = 48  # over the whole sphere

_WALLS_ASKED = 24  # of these


# A hollow has a core walled in nearly all around, and reaches to where a little more than half is walled;
# sheets are the greater part of those walls. An open half sphere walls in at most 0.85, at its pole, so bowls
# and shells to sit in have no core; a square tray has one in its corners if it is deeper than about a quarter
# of its width.
_CORE_WALLED = 0.9

_EDGE_WALLED = 0.55

_SHEETS = 0.5


def find_hollow(solid: TriangleMesh, sheet_thickness: float) -> TriangleMesh | None:
    """A plug: closed surfaces that fill what is hollow in a watertight solid, or None if nothing is.

    Args:
        solid: watertight, oriented outward.
        sheet_thickness: walls thinner than this, in the solid's units, are sheets.

    Returns:
        Surface of the hollow voxels, oriented outward, snapped to the walls where it comes near them.
    """
    import igl  # noqa: PLC0415

    hollow, origin, step = hollow_voxels(solid, sheet_thickness)
    if not hollow.any():
        return None
    filled = np.pad(hollow, 1).astype(np.float64)
    # igl runs through x fastest, and takes what is below the level to be inside.
    cells = np.stack(np.unravel_index(np.arange(filled.size), filled.shape, order="F"), axis=1)
    places = origin + step * (cells - 1)
    vertices, faces, _ = igl.marching_cubes(-filled.ravel(order="F"), places, *filled.shape, -0.5)
    return TriangleMesh(_snap(vertices, solid, reach=1.5 * step), faces.astype(np.int64))


def hollow_voxels(
    solid: TriangleMesh, sheet_thickness: float
) -> tuple[Bool[np.ndarray, "X Y Z"], Float[np.ndarray, "3"], float]:
    """Which voxels are hollow, the centre of the first one, and their size."""
    points, shape, step = _voxels(solid)
    outside = ~is_inside(points, solid.vertices, solid.faces)
    visibility = Visibility(solid.triangles)
    walled, sheets = np.zeros((2, len(points)))
    walled[outside], sheets[outside] = _wall_shares(visibility, points[outside], sheet_thickness)
    members = np.flatnonzero((walled > _EDGE_WALLED) & (sheets > _SHEETS * walled))
    rooms = _label_rooms(visibility, points, members, shape, step)
    cored = np.unique(rooms[walled[members] > _CORE_WALLED])
    hollow = np.zeros(len(points), dtype=bool)
    hollow[members] = np.isin(rooms, cored)
    # Opening by one voxel drops films along walls.
    return ndimage.binary_opening(hollow.reshape(shape)), points[0], step


def _voxels(solid: TriangleMesh) -> tuple[Float[np.ndarray, "P 3"], tuple[int, int, int], float]:
    """Centres of the voxels of the bounding box, z fastest; how many along each axis; their size."""
    low, high = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
    step = float((high - low).max()) / _CELLS
    x, y, z = (int(np.ceil(length / step)) for length in high - low)
    return low + step * (np.indices((x, y, z)).reshape(3, -1).T + 0.5), (x, y, z), step


def _wall_shares(
    visibility: Visibility, points: Float[np.ndarray, "P 3"], sheet_thickness: float
) -> tuple[Float[np.ndarray, "P"], Float[np.ndarray, "P"]]:
    """Shares of the directions from each point that meet a wall, and that meet a sheet first.

    Both are right for points walled in beyond the edge share; the others are given up as soon as they cannot
    be, which is early for most.
    """
    half = spread_directions(_DIRECTIONS // 2)
    directions = np.stack([half, -half], axis=1).reshape(-1, 3)
    free = np.zeros(len(points), dtype=int)
    most_free = (1 - _EDGE_WALLED) * _DIRECTIONS
    for direction in directions:
        asked = np.flatnonzero(free < most_free)
        free[asked] += visibility.sees_out(points[asked], direction[None])
    asked = np.flatnonzero(free < most_free)
    sheets = np.zeros(len(points))
    # A wall's thickness takes two dearer rays, and no fine count: every part of the list is spread evenly.
    for direction in directions[:_WALLS_ASKED]:
        sheets[asked] += visibility.first_wall(points[asked], direction) < sheet_thickness
    return 1 - free / _DIRECTIONS, sheets / _WALLS_ASKED


def _label_rooms(
    visibility: Visibility,
    points: Float[np.ndarray, "P 3"],
    members: Int[np.ndarray, "M"],
    shape: tuple[int, int, int],
    step: float,
) -> Int[np.ndarray, "M"]:
    """Number of the room each member voxel is in: neighbours share one unless a wall is between them.

    Labelling the voxels alone would join rooms through their walls, for a sheet is thinner than a voxel.
    """
    rank = np.full(len(points), -1)
    rank[members] = np.arange(len(members))
    rank = rank.reshape(shape)
    links = [np.zeros((2, 0), dtype=int)]
    for axis in range(3):
        pair = np.stack([np.delete(rank, -1, axis).ravel(), np.delete(rank, 0, axis).ravel()])
        pair = pair[:, (pair >= 0).all(axis=0)]
        links.append(pair[:, visibility.sees_out(points[members[pair[0]]], np.eye(3)[[axis]], reach=step)])
    here, there = np.concatenate(links, axis=1)
    return label_components(here, there, len(members))


def _snap(vertices: Float[np.ndarray, "V 3"], solid: TriangleMesh, reach: float) -> Float[np.ndarray, "V 3"]:
    """Vertices within reach of the solid moved onto it."""
    import igl  # noqa: PLC0415

    squared, _, nearest = igl.point_mesh_squared_distance(vertices, solid.vertices, solid.faces)
    return np.where((squared < reach**2)[:, None], nearest, vertices)
