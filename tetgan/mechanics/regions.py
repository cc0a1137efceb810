"""Regions of a boundary, by name or box, where a body is held or loaded."""

import re
from dataclasses import dataclass
from functools import cached_property

import igl
import numpy as np
from jaxtyping import Bool, Float

from tetgan.errors import UserError
from tetgan.mechanics.errors import UnfitError

SIDES = {"left": (0, -1), "right": (0, 1), "floor": (1, -1), "top": (1, 1), "back": (2, -1), "front": (2, 1)}
"""Axis and direction of each named side; y points up, z to the front."""

DOWN = (0.0, -1.0, 0.0)

_FACING = 0.5  # cosine of the angle up to which a face looks to the side it belongs to

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

_FORCE = re.compile(rf"({_NUMBER}(?:,{_NUMBER},{_NUMBER})?) ?(k?)N")


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


@dataclass(frozen=True)
class Support:
    """A region, and which components of the displacement are zero there."""

    region: str
    components: tuple[bool, bool, bool]


@dataclass(frozen=True)
class Load:
    """A region, and the sum of the forces that act on it, in newtons."""

    region: str
    force: tuple[float, float, float]


def parse_support(text: str) -> Support:
    """`floor` is held in every direction, `floor/y` in the vertical alone, `floor/xz` along the ground.

    Raises:
        UserError: the letters after the stroke are not of x, y, z.
    """
    region, stroke, letters = text.partition("/")
    if stroke and not re.fullmatch("[xyz]+", letters):
        raise UserError(f"fix: '{text}': after '/' come the directions held, such as '/y' or '/xz'")
    x, y, z = (axis in (letters or "xyz") for axis in "xyz")
    return Support(region, (x, y, z))


def parse_load(text: str) -> Load:
    """`top=500N` acts downward, `left=200,0,-50N` along a vector; `kN` is known.

    Raises:
        UserError: it has another form.
    """
    region, _, force = text.rpartition("=")
    found = _FORCE.fullmatch(force.strip())
    if not region or found is None:
        raise UserError(f"load: '{text}' is not of the form 'top=500N' or 'left=200,0,-50N'")
    values = np.array([float(number) for number in found[1].split(",")]) * (1000 if found[2] else 1)
    if not np.isfinite(values).all():
        raise UserError(f"load: '{text}' is larger than any number; give a smaller one")
    x, y, z = (values if len(values) == 3 else values[0] * np.array(DOWN)).tolist()
    return Load(region, (x, y, z))


def choose_faces(region: str, faces: BoundaryFaces, reach: float) -> Bool[np.ndarray, "F"]:
    """Faces of a region: by name those that look to a side and lie near it, or those centred in a box.

    Args:
        reach: depth of a named side, over the mesh's longest extent.

    Raises:
        UserError: no such region.
        UnfitError: nothing in it.
    """
    if region in SIDES:
        chosen = _at_side(*SIDES[region], faces, reach)
    else:
        chosen = _inside(*_corners(region), faces.middles)
    if not chosen.any():
        low, high = (",".join(f"{value:.3g}" for value in corner) for corner in (faces.low, faces.high))
        remedy = "give a larger reach, or a box" if region in SIDES else "move its corners"
        raise UnfitError(
            "empty region", f"region '{region}' holds no face of the mesh, which spans {low}:{high}; {remedy}"
        )
    return chosen


def carry_over(
    chosen: Bool[np.ndarray, "F"], faces: BoundaryFaces, others: BoundaryFaces
) -> Bool[np.ndarray, "G"]:
    """Faces of another mesh of the same surface nearest to chosen ones, by their centroids."""
    vertices, count = faces.corners.reshape(-1, 3), len(chosen)
    _, nearest, _ = igl.point_mesh_squared_distance(
        others.middles, vertices, np.arange(3 * count).reshape(-1, 3)
    )
    return chosen[nearest]


def _at_side(axis: int, direction: int, faces: BoundaryFaces, reach: float) -> Bool[np.ndarray, "F"]:
    """Faces that look to a side, and lie little further in than the outermost of them."""
    looking = direction * faces.normals[:, axis] > _FACING
    height = direction * faces.middles[:, axis]
    depth = (reach + 1e-9) * float((faces.high - faces.low).max())
    return looking & (height >= height.max(where=looking, initial=-np.inf) - depth)


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
        raise UserError(f"region '{region}' is none of {', '.join(SIDES)}, nor a box 'x,y,z:x,y,z'") from None
    return np.minimum(one, other), np.maximum(one, other)
