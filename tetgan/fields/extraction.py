"""Fields of closed surface meshes, for one shape and for a shard."""

from dataclasses import dataclass
from pathlib import Path

import igl
import numpy as np
from jaxtyping import Bool, Float, Int
from rich.console import Console
from rich.progress import track

from tetgan.fields.field import Field
from tetgan.fields.store import write_shard
from tetgan.geometry.components import label_components
from tetgan.geometry.inside import is_inside
from tetgan.grids.graded import GradedGrid, graded_grid
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import grid_from_options
from tetgan.grids.lattice import Lattice
from tetgan.grids.options import GridOptions, Interior
from tetgan.shapes.archive import read_meshes


def extract_field(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], grid: TetGrid) -> Field:
    """Occupancy and displacement at every centroid of `grid`.

    The paper asks for a winding number above 0, its code rounds it: above ½, which also forgives the
    approximation of the fast winding number (Barill et al. 2018). Closest points are exact.

    Args:
        vertices, faces: a closed surface that faces outward, in the unit cube.

    Raises:
        ValueError: the mesh has no faces.
    """
    vertices, faces = _contiguous(vertices, faces)
    squared, _, closest = igl.point_mesh_squared_distance(grid.centroids, vertices, faces)
    return _field(np.sqrt(squared), closest, vertices, faces, grid)


def extract_graded(
    vertices: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    base: Lattice,
    depth: int,
    *,
    reach: float = 1.0,
    interior: Interior = "graded",
) -> tuple[GradedGrid, Field]:
    """The field of `extract_field` on a lattice that is fine only near the surface.

    Every tet that comes within `reach` of the surface is of the finest level, with the values that it has on
    `subdivide_lattice(base, depth).finest`: a tet is subdivided unless the distance of its centroid shows
    that no point of it is that near.

    Args:
        vertices, faces: a closed surface that faces outward, in the unit cube.
        base: a lattice that covers the unit cube.
        depth: number of subdivisions near the surface.
        reach: in longest edges of the finest level; 1 makes all tets fine at the ends of every edge that the
            surface crosses.
        interior: `fine` subdivides all tets inside as well. Those out of reach are not looked up one by one:
            their displacement ends at the surface, in the point closest to the first ancestor that was out
            of reach, so it is no shorter than the distance.

    Raises:
        ValueError: the mesh has no faces.
    """
    vertices, faces = _contiguous(vertices, faces)
    margin = reach * base.longest_edge / (base.unit * 2**depth)
    count = len(base.tets)
    choice = _Choice(
        vertices, faces, margin, interior == "fine", np.zeros(count, dtype=bool), np.empty((count, 3))
    )
    grid = graded_grid(base, depth, choice)
    # Of the finest tets, which are the last, the children of those chosen last come first.
    deep = np.count_nonzero(grid.level < depth) + np.flatnonzero(choice.deep)
    asked = np.ones(len(grid.tets), dtype=bool)
    asked[deep] = False
    distances, closest = np.full(len(grid.tets), margin), np.empty((len(grid.tets), 3))
    squared, _, closest[asked] = igl.point_mesh_squared_distance(grid.centroids[asked], vertices, faces)
    distances[asked], closest[deep] = np.sqrt(squared), choice.closest[choice.deep]
    return grid, _field(distances, closest, vertices, faces, grid)


@dataclass(eq=False)
class _Choice:
    """Chooses tets within `margin` of a surface and, where `fine` is set, those inside.

    Attributes:
        deep: (N,) of the tets to be asked for next, which are the children of those chosen last, those that
            are inside and out of reach because an ancestor is.
        closest: (N, 3) for deep ones, the point of the surface that is closest to that ancestor's centroid.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    margin: float
    fine: bool
    deep: Bool[np.ndarray, "N"]
    closest: Float[np.ndarray, "N 3"]

    def __call__(self, level: int, corners: Float[np.ndarray, "N 4 3"]) -> Bool[np.ndarray, "N"]:
        centroids = corners.mean(axis=1)
        asked = np.flatnonzero(~self.deep)
        radii = np.linalg.norm(corners[asked] - centroids[asked, None], axis=2).max(axis=1)
        squared, _, self.closest[asked] = igl.point_mesh_squared_distance(
            centroids[asked], self.vertices, self.faces
        )
        far = asked[np.sqrt(squared) > radii + self.margin]
        if self.fine:
            self.deep[far] = is_inside(centroids[far], self.vertices, self.faces)
        chosen = np.ones(len(corners), dtype=bool)
        chosen[far] = self.deep[far]
        self.deep, self.closest = (np.repeat(array[chosen], 8, axis=0) for array in (self.deep, self.closest))
        return chosen


def _field(
    distances: Float[np.ndarray, "T"],
    closest: Float[np.ndarray, "T 3"],
    vertices: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    grid: TetGrid,
) -> Field:
    """Displacement to `closest`; occupancy by regions, for which the distances may be lower bounds."""
    asked, region = _regions(distances, grid)
    occupied = is_inside(grid.centroids[asked], vertices, faces)
    return Field(occupied[region], (closest - grid.centroids).astype(np.float32))


def _contiguous(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]
) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "F 3"]]:
    """A mesh as libigl takes it."""
    if len(faces) == 0:
        raise ValueError("a mesh without faces has no field")
    return np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.int64)


def _regions(
    distances: Float[np.ndarray, "T"], grid: TetGrid
) -> tuple[Int[np.ndarray, "R"], Int[np.ndarray, "T"]]:
    """Sets of tets on one side of a surface: the tet of each that is furthest from it, and each tet's set.

    Neighbours are on one side where the distance between their centroids is less than that of one of them to
    the surface: the segment lies in a ball that the surface does not enter.
    """
    tets, slots = np.nonzero(grid.neighbors > np.arange(len(grid.tets))[:, None])
    others = grid.neighbors[tets, slots]
    apart = np.linalg.norm(grid.centroids[tets] - grid.centroids[others], axis=1)
    joined = apart < np.maximum(distances[tets], distances[others])
    region = label_components(tets[joined], others[joined], len(grid.tets))
    furthest = np.empty(region.max() + 1, dtype=np.int64)
    order = np.argsort(distances)
    furthest[region[order]] = order  # of several writes to one place the last one stays
    return furthest, region


def extract_shard(meshes: Path, out: Path, grid: GridOptions) -> None:
    """Extract the field of every mesh in an archive; one mesh is in memory at a time.

    Raises:
        UserError: the archive or the grid file cannot be read.
    """
    hierarchy = grid_from_options(grid)
    ids = [shape_id for shape_id, _, _ in read_meshes(meshes)]
    progress = track(read_meshes(meshes), description="fields", total=len(ids), console=Console(stderr=True))
    fields = (extract_field(vertices, faces, hierarchy.finest) for _, vertices, faces in progress)
    write_shard(out, ids, fields, hierarchy.digest)
