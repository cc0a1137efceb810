"""Shapes read from files, whole or cut open, for drawing."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from jaxtyping import Bool, Float, Int

from tetgan.geometry.adjacency import FACES, face_keys
from tetgan.geometry.tets import TetMesh
from tetgan.rendering.figure import Shape
from tetgan.rendering.raycast import STEEL
from tetgan.shapes.archive import pick_meshes
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.loading import parse_mesh, read_file
from tetgan.solids.reading import read_solid

INSIDE: tuple[float, float, float] = (0.93, 0.55, 0.22)  # colour of the faces a cut opens, linear RGB

_SHADES = 0.22  # how much the opened tets differ in brightness

_GOLDEN = 0.6180339887498949


def cut_solid(solid: TetMesh, normal: Float[np.ndarray, "3"], offset: float | int) -> Shape:
    """Surface of the tets whose centroids lie behind a plane, on the solid's vertices.

    Whole tets are dropped, not cut, so the opened side shows them; they differ a little in brightness.

    Args:
        normal, offset: the plane x . normal = offset, `normal` of any length; what lies beyond it goes.

    Returns:
        Outward faces, the skin of the solid in one colour, opened faces in another.
    """
    kept = solid.centroids @ normal <= offset
    faces, owner = solid.tets[:, FACES].reshape(-1, 3), np.repeat(np.arange(len(solid.tets)), 4)
    skin = _used_once(faces)
    kept_faces, kept_owner = faces[kept[owner]], owner[kept[owner]]
    shown = _used_once(kept_faces)
    opened = ~skin[kept[owner]][shown]
    colors = np.tile(np.array(STEEL), (int(shown.sum()), 1))
    brightness = 1 + _SHADES * (np.mod(kept_owner[shown][opened] * _GOLDEN, 1.0) - 0.5) * 2
    colors[opened] = np.clip(brightness[:, None] * np.array(INSIDE), 0, 1)
    return Shape(solid.vertices, kept_faces[shown], colors)


def _used_once(faces: Int[np.ndarray, "F 3"]) -> Bool[np.ndarray, "F"]:
    """Which faces bound the solid: no other tet has the same three corners."""
    _, index, count = np.unique(face_keys(faces), return_inverse=True, return_counts=True)
    return count[index] == 1


CUT: tuple[float, float, float] = (1.0, 0.0, 0.35)
"""Normal of the plane by which figures cut: from the right, where its camera is at `CUT_AZIMUTH`."""

CUT_AZIMUTH = 60


def read_shape(
    path: Path, colors: Float[np.ndarray, "F 3"] | tuple[float, float, float] = STEEL
) -> Shape | None:
    """The surface of a file, its faces in their order; None where there is no file or no face."""
    try:
        soup = parse_mesh(read_file(path), path.suffix)
    except ShapeError:
        return None
    return Shape(soup.vertices, soup.faces, colors)


def list_shapes(shown: Sequence[tuple[str, str, str, Shape | None]]) -> pd.DataFrame:
    """The table beside a figure from model, set, id and shape of all in it; an empty one has no faces."""
    rows = [(*names, 0 if shape is None else len(shape.faces)) for *names, shape in shown]
    return pd.DataFrame(rows, columns=["model", "set", "id", "faces"])


def cut_open(path: Path, normal: Sequence[float | int], share: float = 0.5) -> Shape | None:
    """A solid from a file without what lies beyond a plane, so that its inside shows; None without a file.

    Args:
        normal: of the plane, towards the side that goes.
        share: how far along the normal the plane stands, from one end of the solid (0) to the other (1).

    Raises:
        UserError: the file cannot be read, or holds no tets.
    """
    if not path.is_file():
        return None
    solid, across = read_solid(path), np.asarray(normal, dtype=float)
    along = solid.vertices @ across
    return cut_solid(solid, across, float(along.min() + share * np.ptp(along)))


def read_originals(archives: Sequence[str | Path], ids: Sequence[str]) -> list[Shape | None]:
    """Repaired meshes by id, None for an id that no archive holds."""
    found = pick_meshes([Path(archive) for archive in archives], ids)
    return [Shape(found[i].vertices, found[i].faces) if i in found else None for i in ids]
