"""Regions of a boundary: a side by its name, a box, a plane, or all of it."""

import re
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from tetgan.errors import UserError
from tetgan.geometry.triangles import area_normals

SIDES = {"left": (0, -1), "right": (0, 1), "floor": (1, -1), "top": (1, 1), "back": (2, -1), "front": (2, 1)}
"""Axis and direction of each named side; y points up, z to the front."""

SURFACE = "surface"
"""The region of all boundary faces."""

REACH = 0.05
"""Depth of a named side, over the mesh's longest extent."""

_FACING = 0.5  # cosine of the angle up to which a face looks to the side it belongs to

_FLAT = 1e-6  # over the mesh's longest extent: how far from a plane the corners of its faces may lie

_PLANE = re.compile(r"\s*([xyz])\s*([<=>])\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*")


@dataclass(frozen=True, eq=False)
class BoundaryFaces:
    """Boundary faces from which regions choose.

    Attributes:
        corners: (F, 3, 3) of each face its corners, in the units of the mesh.
        normals: (F, 3) unit normals, outward.
        low, high: (3,) corners of the box around the mesh.
    """

    corners: Float[np.ndarray, "F 3 3"]
    normals: Float[np.ndarray, "F 3"]
    low: Float[np.ndarray, "3"]
    high: Float[np.ndarray, "3"]

    @cached_property
    def middles(self) -> Float[np.ndarray, "F 3"]:
        """Centroids of the faces."""
        return self.corners.mean(axis=1)

    @property
    def extent(self) -> float:
        """The longest side of the box."""
        return float((self.high - self.low).max())


def faces_of_tets(corners: Float[np.ndarray, "F 3 3"], tets: Float[np.ndarray, "F 4 3"]) -> BoundaryFaces:
    """All faces of a boundary, however their corners turn.

    Args:
        tets: of each face the corners of its tet, which tell where outside is.
    """
    normals = area_normals(corners)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    outward = np.einsum("fc,fc->f", normals, corners.mean(axis=1) - tets.mean(axis=1)) > 0
    points = corners.reshape(-1, 3)  # the outermost vertices of a mesh are on its boundary
    return BoundaryFaces(
        corners, np.where(outward[:, None], normals, -normals), points.min(axis=0), points.max(axis=0)
    )


def find_faces(region: str, faces: BoundaryFaces, reach: float = REACH) -> Bool[np.ndarray, "F"]:
    """Faces of a region; it may be empty.

    - `surface`: all;
    - `floor`, `top`, `left`, …: those that look to that side and lie near it;
    - `y=0`: those in a plane; `y<0.1`, `y>0.1`: those centred on one side of it;
    - `x,y,z:x,y,z`: those centred in a box with these corners.

    Args:
        reach: depth of a named side, over the mesh's longest extent.

    Raises:
        UserError: no such region.
    """
    if region == SURFACE:
        return np.ones(len(faces.corners), dtype=bool)
    if region in SIDES:
        return _at_side(*SIDES[region], faces, reach)
    plane = _PLANE.fullmatch(region)
    if plane is not None:
        return _at_plane("xyz".index(plane[1]), plane[2], float(plane[3]), faces)
    return _inside(*_corners(region), faces.middles)


def emptiness(region: str, faces: BoundaryFaces) -> str:
    """The error of a region without faces: where the mesh is, and the remedy."""
    low, high = (",".join(f"{value:.3g}" for value in corner) for corner in (faces.low, faces.high))
    remedy = "give a larger reach, or a box" if region in SIDES else "move it"
    return f"region '{region}' holds no face of the mesh, which spans {low}:{high}; {remedy}"


def _at_side(axis: int, direction: int, faces: BoundaryFaces, reach: float) -> Bool[np.ndarray, "F"]:
    """Faces that look to a side, and lie little further in than the outermost of them."""
    looking = direction * faces.normals[:, axis] > _FACING
    height = direction * faces.middles[:, axis]
    depth = (reach + 1e-9) * faces.extent
    return looking & (height >= height.max(where=looking, initial=-np.inf) - depth)


def _at_plane(axis: int, relation: str, at: float, faces: BoundaryFaces) -> Bool[np.ndarray, "F"]:
    if relation == "=":
        off = np.abs(faces.corners[:, :, axis] - at)
        return off.max(axis=1) <= _FLAT * faces.extent
    beyond = faces.middles[:, axis] - at
    return beyond < 0 if relation == "<" else beyond > 0


def _inside(
    low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"], points: Float[np.ndarray, "F 3"]
) -> Bool[np.ndarray, "F"]:
    slack = 1e-9 * max(1.0, float(np.abs(points).max(initial=0)))
    inside = (points >= low - slack) & (points <= high + slack)
    return np.asarray(inside.all(axis=1))


def _corners(region: str) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Corners of the box `x,y,z:x,y,z`, in either order."""
    corners = [corner.split(",") for corner in region.split(":")]
    try:
        one, other = (np.array([float(number) for number in corner]) for corner in corners)
        if one.shape != (3,) or other.shape != (3,):
            raise ValueError
    except ValueError:
        raise UserError(
            f"region '{region}' is none of {SURFACE}, {', '.join(SIDES)}, nor a box 'x,y,z:x,y,z',"
            " nor a plane 'y=0' or one side of it, 'y<0.1'"
        ) from None
    return np.minimum(one, other), np.maximum(one, other)
