"""A solid opened by a plane, so that the tetrahedra inside it show."""

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.rendering.raycast import STEEL

INSIDE: tuple[float, float, float] = (0.93, 0.55, 0.22)  # colour of the faces a cut opens, linear RGB
_SHADES = 0.22  # how much the opened tets differ in brightness
_GOLDEN = 0.6180339887498949
# Corners of the faces of a positively oriented tet, each opposite one vertex and wound outwards.
_FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])


def cut_solid(
    vertices: Float[np.ndarray, "V 3"],
    tets: Int[np.ndarray, "T 4"],
    normal: Float[np.ndarray, "3"],
    offset: float | int,
) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "F 3"], Float[np.ndarray, "F 3"]]:
    """Surface of the tets whose centroids lie behind a plane, with a colour a face for `render_mesh`.

    Whole tets are dropped, not cut, so the opened side shows them; they differ a little in brightness.

    Args:
        normal, offset: the plane x . normal = offset, `normal` of any length; what lies beyond it goes.

    Returns:
        The same vertices, outward faces, and linear RGB: the skin of the solid in one colour, opened faces in
        another.
    """
    kept = vertices[tets].mean(axis=1) @ normal <= offset
    faces, owner = _faces_of(tets)
    skin = _used_once(faces)
    kept_faces, kept_owner = faces[kept[owner]], owner[kept[owner]]
    shown = _used_once(kept_faces)
    opened = ~skin[kept[owner]][shown]
    colors = np.tile(np.array(STEEL), (int(shown.sum()), 1))
    brightness = 1 + _SHADES * (np.mod(kept_owner[shown][opened] * _GOLDEN, 1.0) - 0.5) * 2
    colors[opened] = np.clip(brightness[:, None] * np.array(INSIDE), 0, 1)
    return vertices, kept_faces[shown], colors


def _faces_of(tets: Int[np.ndarray, "T 4"]) -> tuple[Int[np.ndarray, "F 3"], Int[np.ndarray, "F"]]:
    """All four faces of every tet, and the tet of each."""
    return tets[:, _FACES].reshape(-1, 3), np.repeat(np.arange(len(tets)), 4)


def _used_once(faces: Int[np.ndarray, "F 3"]) -> Bool[np.ndarray, "F"]:
    """Which faces bound the solid: no other tet has the same three corners."""
    _, index, count = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True)
    return count[index.reshape(-1)] == 1
