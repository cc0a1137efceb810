"""The surface that marching cubes finds in voxels of the unit cube."""

from collections.abc import Callable, Iterator
from itertools import product
from typing import NamedTuple

import igl
import numpy as np
from jaxtyping import Float, Int

Triangles = tuple[Float[np.ndarray, "_V 3"], Int[np.ndarray, "_F 3"]]
Distance = Callable[[Float[np.ndarray, "P 3"]], Float[np.ndarray, "P"]]

_BLOCK = 32  # voxels along a block: small enough for memory, large enough for array speed


class VoxelSurfaces(NamedTuple):
    """Two surfaces from the same voxels: of what is inside, and of the distance stored in each."""

    binary: Triangles
    distance: Triangles


def voxel_surfaces(signed_distance: Distance, resolution: int) -> VoxelSurfaces:
    """Marching cubes (Lorensen and Cline 1987) on the centres of resolution³ voxels.

    Binary voxels cut every edge between inside and outside in its middle; distances say where to cut it.
    Blocks whose middle lies further from the surface than their corners hold none of it and are left out:
    a true distance changes no faster than one moves. Vertices are not shared between blocks.

    Args:
        signed_distance: negative inside, never longer than the true distance. Nothing may be inside at the
            wall of the cube or beyond it.
    """
    pieces = [
        _march(values, places)
        for places in _blocks(signed_distance, resolution)
        for values in _two_readings(signed_distance(places.reshape(-1, 3)))
    ]
    return VoxelSurfaces(_join(pieces[0::2]), _join(pieces[1::2]))


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


def _two_readings(distances: Float[np.ndarray, "P"]) -> tuple[Float[np.ndarray, "P"], ...]:
    return np.where(distances < 0, -1.0, 1.0), distances


def _march(values: Float[np.ndarray, "P"], places: Float[np.ndarray, "X Y Z 3"]) -> Triangles:
    """Surface at value zero, facing outward.

    igl runs through its first axis fastest, so the axes are handed over in reverse, which turns faces round.
    """
    vertices, faces, _ = igl.marching_cubes(values, places.reshape(-1, 3), *places.shape[2::-1], 0.0)
    return vertices.reshape(-1, 3), faces.astype(np.int64).reshape(-1, 3)[:, ::-1]


def _join(pieces: list[Triangles]) -> Triangles:
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    vertices = np.concatenate([np.empty((0, 3)), *(vertices for vertices, _ in pieces)])
    faces = [faces + start for (_, faces), start in zip(pieces, starts, strict=False)]
    return vertices, np.concatenate([np.empty((0, 3), dtype=np.int64), *faces])
