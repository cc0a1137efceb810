"""Surfaces of voxels of the unit cube: their cubes, and marching cubes."""

from collections.abc import Callable, Iterator
from itertools import product
from typing import NamedTuple

import igl
import numpy as np
from jaxtyping import Bool, Float

from tetgan.geometry.triangles import TriangleMesh, join_meshes

Distance = Callable[[Float[np.ndarray, "P 3"]], Float[np.ndarray, "P"]]

_BLOCK = 32  # voxels along a block: small enough for memory, large enough for array speed


class VoxelSurfaces(NamedTuple):
    """Three surfaces from the same voxels.

    Attributes:
        blocky: the boundary of the cubes whose centre is inside.
        binary: marching cubes on whether a centre is inside.
        distance: marching cubes on the signed distance of every centre.
    """

    blocky: TriangleMesh
    binary: TriangleMesh
    distance: TriangleMesh


def voxel_surfaces(signed_distance: Distance, resolution: int) -> VoxelSurfaces:
    """The surfaces of resolution³ voxels: their cubes, and marching cubes (Lorensen and Cline 1987).

    Binary voxels cut every edge between inside and outside in its middle; distances say where to cut it.
    Blocks whose middle lies further from the surface than their corners hold none of it and are left out:
    a true distance changes no faster than one moves. Vertices are not shared between blocks, nor between
    the sides of cubes.

    Args:
        signed_distance: negative inside, never longer than the true distance. Nothing may be inside at the
            wall of the cube or beyond it.
    """
    blocky: list[TriangleMesh] = []
    binary: list[TriangleMesh] = []
    distance: list[TriangleMesh] = []
    for places in _blocks(signed_distance, resolution):
        distances = signed_distance(places.reshape(-1, 3))
        inside = distances < 0
        blocky += _cube_sides(inside.reshape(places.shape[:3]), places, 1 / resolution)
        binary.append(_march(np.where(inside, -1.0, 1.0), places))
        distance.append(_march(distances, places))
    return VoxelSurfaces(join_meshes(blocky), join_meshes(binary), join_meshes(distance))


def _blocks(signed_distance: Distance, resolution: int) -> Iterator[Float[np.ndarray, "X Y Z 3"]]:
    """Places of the voxel centres of each block that the surface may cross.

    Neighbouring blocks share a layer, and the outermost voxels lie half a voxel beyond the wall, so that
    the surface closes.
    """
    for first in product(range(-1, resolution, _BLOCK), repeat=3):
        last = np.minimum(np.array(first) + _BLOCK, resolution)
        ends = (np.stack([first, last]) + 0.5) / resolution
        reach = np.linalg.norm(ends[1] - ends[0]) / 2
        if abs(signed_distance(ends.mean(axis=0)[None])[0]) <= reach:
            axes = [
                (np.arange(low, high + 1) + 0.5) / resolution for low, high in zip(first, last, strict=True)
            ]
            yield np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def _cube_sides(
    inside: Bool[np.ndarray, "X Y Z"], places: Float[np.ndarray, "X Y Z 3"], step: float
) -> Iterator[TriangleMesh]:
    """For each axis, the squares between a voxel inside and its neighbour outside, facing outward.

    The last layer of a block across the axis is the first one of the next block, which has its squares.
    """
    for axis in range(3):
        across = tuple(slice(None) if other == axis else slice(-1) for other in range(3))
        here, there = (np.moveaxis(inside[across], axis, 0)[part] for part in (slice(-1), slice(1, None)))
        centres = np.moveaxis(places[across], axis, 0)[:-1] + step / 2 * np.eye(3)[axis]
        first, second = step / 2 * np.eye(3)[[(axis + 1) % 3, (axis + 2) % 3]]
        ring = np.stack([-first - second, first - second, first + second, second - first])
        for found, turn in ((here & ~there, 1), (there & ~here, -1)):
            corners = centres[found][:, None] + ring
            squares = np.arange(corners.size // 3).reshape(-1, 4)
            faces = np.concatenate([squares[:, [0, 1, 2]], squares[:, [0, 2, 3]]])
            yield TriangleMesh(corners.reshape(-1, 3), faces[:, ::turn])


def _march(values: Float[np.ndarray, "P"], places: Float[np.ndarray, "X Y Z 3"]) -> TriangleMesh:
    """Surface at value zero, facing outward.

    igl runs through its first axis fastest, so the axes are handed over in reverse, which turns faces round.
    """
    vertices, faces, _ = igl.marching_cubes(values, places.reshape(-1, 3), *places.shape[2::-1], 0.0)
    return TriangleMesh(vertices.reshape(-1, 3), faces.astype(np.int64).reshape(-1, 3)[:, ::-1])
