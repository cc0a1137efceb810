"""Regions of a boundary where a body is held or loaded."""

import re
from dataclasses import dataclass

import igl
import numpy as np
from jaxtyping import Bool

from tetgan.errors import UserError
from tetgan.mechanics.errors import UnfitError
from tetgan.solids.regions import BoundaryFaces, emptiness, find_faces

DOWN = (0.0, -1.0, 0.0)

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

_FORCE = re.compile(rf"({_NUMBER}(?:,{_NUMBER},{_NUMBER})?) ?(k?)N")


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
    """Faces of a region, at least one; see `find_faces`.

    Args:
        reach: depth of a named side, over the mesh's longest extent.

    Raises:
        UserError: no such region.
        UnfitError: nothing in it.
    """
    chosen = find_faces(region, faces, reach)
    if not chosen.any():
        raise UnfitError("empty region", emptiness(region, faces))
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
