"""Shapes from files, ready to draw."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import meshio
import numpy as np
import pandas as pd
from jaxtyping import Float, Int

from tetgan.rendering.cutaway import cut_solid
from tetgan.rendering.figure import Shape
from tetgan.rendering.raycast import STEEL
from tetgan.shapes.archive import pick_meshes
from tetgan.shapes.loading import parse_mesh, read_file
from tetgan.shapes.soup import ShapeError

CUT: tuple[float, float, float] = (1.0, 0.0, 0.35)
"""Normal of the plane by which figures cut: from the right, where its camera stands at `CUT_AZIMUTH`."""
CUT_AZIMUTH = 60


class Solid(NamedTuple):
    """Tets on shared vertices."""

    vertices: Float[np.ndarray, "V 3"]
    tets: Int[np.ndarray, "T 4"]


def read_shape(
    path: Path, colors: Float[np.ndarray, "F 3"] | tuple[float, float, float] = STEEL
) -> Shape | None:
    """The surface of a file, its faces in their order; None where there is no file or no face."""
    try:
        soup = parse_mesh(read_file(path), path.suffix)
    except ShapeError:
        return None
    return Shape(soup.vertices, soup.faces, colors)


def read_solid(path: Path) -> Solid | None:
    """The tets of a file; None where there is no file."""
    if not path.is_file():
        return None
    mesh = meshio.read(path)
    return Solid(mesh.points.astype(np.float64), mesh.cells_dict["tetra"].astype(np.int64))


def list_shapes(shown: Sequence[tuple[str, str, str, Shape | None]]) -> pd.DataFrame:
    """The table beside a figure from model, set, id and shape of all in it; an empty one has no faces."""
    rows = [(*names, 0 if shape is None else len(shape.faces)) for *names, shape in shown]
    return pd.DataFrame(rows, columns=["model", "set", "id", "faces"])


def cut_open(solid: Solid | None, normal: Sequence[float | int], share: float = 0.5) -> Shape | None:
    """A solid without what lies beyond a plane, so that its inside shows.

    Args:
        normal: of the plane, towards the side that goes.
        share: how far along the normal the plane stands, from one end of the solid (0) to the other (1).
    """
    if solid is None:
        return None
    along = solid.vertices @ np.asarray(normal, dtype=float)
    offset = along.min() + share * np.ptp(along)
    return Shape(*cut_solid(solid.vertices, solid.tets, np.asarray(normal, dtype=float), float(offset)))


def read_originals(archives: Sequence[str | Path], ids: Sequence[str]) -> list[Shape | None]:
    """Repaired meshes by id, None for an id that no archive holds."""
    found = pick_meshes([Path(archive) for archive in archives], ids)
    return [Shape(found[i].vertices, found[i].faces) if i in found else None for i in ids]


def finished_samples(samples: Path) -> Path:
    """The folder of a model's meshes as they are meant to be shown: smoothed, where the model smooths."""
    return samples / "wls" if (samples / "wls").is_dir() else samples / "none"


def sample_ids(folder: Path, kind: str, count: int | None = None) -> list[str]:
    """Ids of the first `count` meshes of a kind, `generated` or `reconstructed`, in a folder of samples.

    The certificate, where there is one, also names the shapes that came out empty.
    """
    certificate = folder / "certificate.csv"
    if certificate.is_file():
        table = pd.read_csv(certificate, dtype={"id": str, "set": str}, keep_default_na=False)
        return table.loc[table["set"] == kind, "id"].tolist()[:count]
    return sorted(path.stem for path in (folder / kind).glob("*.ply"))[:count]
