"""Insides that a repair left hollow, because an open sheet became a thin shell around nothing.

A vase with a thick wall is open, and stays so; a sofa whose underside was never modelled, a car of single
sheets with a gap in its floor, are hollow. Two shares of the directions around a point tell them apart: those
in which it meets a wall at all, and those in which that wall is a sheet, too thin for a grid to hold.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tetgan.shapes.rays import Visibility, spread_directions
from tetgan.shapes.soup import Soup

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


def find_hollow(solid: Soup, sheet_thickness: float) -> Soup | None:
    """A plug: closed surfaces that fill what is hollow in a watertight solid, or None if nothing is.

    Args:
        solid: watertight, oriented outward.
        sheet_thickness: walls thinner than this, in the solid's units, are sheets.

    Returns:
        Marching-cubes surface of the hollow voxels, snapped to the walls where it comes near them.
    """
    from skimage.measure import marching_cubes  # noqa: PLC0415

    hollow, origin, step = hollow_voxels(solid, sheet_thickness)
    if not hollow.any():
        return None
    vertices, faces, _, _ = marching_cubes(np.pad(hollow, 1).astype(np.float32), 0.5)
    # Marching cubes winds towards the larger value
    placed = origin + step * (vertices.astype(np.float64) - 1)
    return Soup(_snap(placed, solid, reach=1.5 * step), faces[:, ::-1].astype(np.int64))


def hollow_voxels(
    solid: Soup, sheet_thickness: float
) -> tuple[Bool[np.ndarray, "X Y Z"], Float[np.ndarray, "3"], float]:
    """Which voxels are hollow, the centre of the first one, and their size."""
    import igl  # noqa: PLC0415

    low, high = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
    step = float((high - low).max()) / _CELLS
    shape = np.ceil((high - low) / step).astype(int)
    centres = low + step * (np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1) + 0.5)
    points = centres.reshape(-1, 3)
    outside = igl.fast_winding_number(solid.vertices, solid.faces, points) < 0.5
    visibility = Visibility(solid.triangles)
    walled, sheets = np.zeros((2, len(points)))
    walled[outside], sheets[outside] = _wall_shares(visibility, points[outside], sheet_thickness)
    walled = np.where(sheets > _SHEETS * walled, walled, 0)
    members = np.flatnonzero(walled > _EDGE_WALLED)
    links = _open_links(visibility, points, members, shape, step)
    _, labels = connected_components(links, directed=False)
    cored = np.unique(labels[walled[members] > _CORE_WALLED])
    hollow = np.zeros(len(points), dtype=bool)
    hollow[members] = np.isin(labels, cored)
    # Opening by one voxel drops films along walls.
    return ndimage.binary_opening(hollow.reshape(shape)), centres[0, 0, 0], step


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


def _open_links(
    visibility: Visibility,
    points: Float[np.ndarray, "P 3"],
    members: Int[np.ndarray, "M"],
    shape: Int[np.ndarray, "3"],
    step: float,
) -> coo_array:
    """Graph of neighbouring members with no wall between them, (M, M): a sheet is thinner than a voxel."""
    rank = np.full(len(points), -1)
    rank[members] = np.arange(len(members))
    rank = rank.reshape(shape)
    firsts, seconds = [], []
    for axis in range(3):
        here, there = np.delete(rank, -1, axis).ravel(), np.delete(rank, 0, axis).ravel()
        both = (here >= 0) & (there >= 0)
        here, there = here[both], there[both]
        free = visibility.sees_out(points[members[here]], np.eye(3)[axis][None], reach=step)
        firsts.append(here[free])
        seconds.append(there[free])
    first, second = np.concatenate(firsts), np.concatenate(seconds)
    return coo_array((np.ones(len(first)), (first, second)), shape=(len(members),) * 2)


def _snap(vertices: Float[np.ndarray, "V 3"], solid: Soup, reach: float) -> Float[np.ndarray, "V 3"]:
    """Vertices within reach of the solid moved onto it."""
    import igl  # noqa: PLC0415

    squared, _, nearest = igl.point_mesh_squared_distance(vertices, solid.vertices, solid.faces)
    return np.where((squared < reach**2)[:, None], nearest, vertices)
