"""Repair of a triangle soup to a watertight solid: clean, wrap, fill hollow rooms, check."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from tetgan.geometry.boundary import Boundary
from tetgan.geometry.triangles import TriangleMesh, join_meshes
from tetgan.shapes.cleaning import ShapeError, clean_mesh
from tetgan.shapes.hollow import find_hollow
from tetgan.shapes.isolation import RepairWorker
from tetgan.shapes.normalise import normalise
from tetgan.shapes.options import RepairOptions
from tetgan.shapes.sampling import sample_exterior

_DISTANCE_POINTS = 2000


@dataclass(frozen=True, eq=False)
class Repaired:
    """A watertight solid, in the frame in which the raw shape just fits the unit cube.

    Attributes:
        solid: closed, oriented outward; it may leave the unit cube by the offset of the repair.
        volume: of the solid.
        filled_share: how much of that volume was hollow before; 0 for nearly every shape.
        hollow: an inside is still hollow.
        distance: mean from what can be seen of the raw surface to the solid.
    """

    solid: TriangleMesh
    volume: float
    filled_share: float
    hollow: bool
    distance: float


def repair_shape(soup: TriangleMesh, worker: RepairWorker, options: RepairOptions) -> Repaired:
    """Repair one raw shape; lengths are in units of its longest side.

    Raises:
        ShapeError: it cannot be used, or what comes back from the repair is not a solid.
    """
    raw = clean_mesh(soup)
    raw = TriangleMesh(normalise(raw.vertices, margin=0.0), raw.faces)
    solid = worker.repair(raw)
    volume = check_solid(solid)
    distances = surface_distances(raw, solid)
    # Repair puts its offset on both sides of a wall; the median is that offset, crevices apart.
    sheet_thickness = options.sheet_thickness + 2 * float(np.median(distances))
    plug = find_hollow(solid, sheet_thickness)
    filled_share = 0.0
    if plug is not None and options.fill_hollow:
        solid = worker.repair(join_meshes([raw, plug]))
        hollow_volume, volume = volume, check_solid(solid)
        filled_share = 1 - hollow_volume / volume
        distances = surface_distances(raw, solid)
        plug = find_hollow(solid, sheet_thickness)
    return Repaired(solid, volume, filled_share, plug is not None, float(distances.mean()))


def check_solid(solid: TriangleMesh) -> float:
    """Volume of a mesh that is finite, closed, consistently oriented outward and not empty.

    Raises:
        ShapeError: it is not.
    """
    if not len(solid.faces) or not np.isfinite(solid.vertices).all():
        raise ShapeError("repair left no finite surface")
    boundary = Boundary(solid.faces)
    if boundary.nonmanifold_edges or boundary.misoriented_edges:
        raise ShapeError("not watertight after repair")
    if not solid.volume > 0:
        raise ShapeError("no volume after repair")
    return solid.volume


def surface_distances(raw: TriangleMesh, solid: TriangleMesh) -> Float[np.ndarray, "P"]:
    """Distances to the solid from points spread over what can be seen of the raw surface."""
    import igl  # noqa: PLC0415

    try:
        points, _ = sample_exterior(raw.vertices, raw.faces, _DISTANCE_POINTS, seed=0)
    except ValueError as error:
        raise ShapeError(str(error)) from None
    squared, _, _ = igl.point_mesh_squared_distance(points, solid.vertices, solid.faces)
    return np.sqrt(squared)
