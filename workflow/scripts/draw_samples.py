"""Validation shapes beside their reconstructions, random samples, and samples cut open, on one sheet."""

import sys
from itertools import islice
from pathlib import Path

import meshio
import numpy as np
import pandas as pd
import trimesh

from tetgan.rendering.cutaway import cut_solid
from tetgan.rendering.raycast import render_mesh
from tetgan.rendering.sheet import contact_sheet, save_image
from tetgan.shapes.archive import read_meshes

COLUMNS = 8
SIZE = (300, 300)
BLANK = np.full((SIZE[1], SIZE[0], 3), 255, dtype=np.uint8)


def picture(vertices, faces, **options):
    return render_mesh(np.asarray(vertices, float), np.asarray(faces), size=SIZE, span=1.3, **options)


def surface_picture(path: Path):
    """A surface, or an empty cell where the model produced nothing."""
    if not path.exists():
        return BLANK
    mesh = trimesh.load(path, process=False)
    return picture(mesh.vertices, mesh.faces)


def cut_picture(path: Path):
    """A solid without the half of it that is nearer, so that its inside shows."""
    if not path.exists():
        return BLANK
    solid = meshio.read(path)
    normal = np.array([1.0, 0.0, 0.35])
    middle = (solid.points.min(axis=0) + solid.points.max(axis=0)) / 2
    vertices, faces, colors = cut_solid(
        solid.points, solid.cells_dict["tetra"].astype(np.int64), normal, float(middle @ normal)
    )
    return picture(vertices, faces, colors=colors, azimuth=60)


def row_of(pictures):
    return (list(pictures) + [BLANK] * COLUMNS)[:COLUMNS]


def ids_of(folder: Path, kind: str) -> list[str]:
    certificate = pd.read_csv(folder / "certificate.csv", dtype={"id": str})
    return certificate.loc[certificate["set"] == kind, "id"].tolist()[:COLUMNS]


def model_rows(samples: Path, name: str):
    """Rows of one model: reconstructions, samples, samples cut open; all smoothed (Eq. 4)."""
    folder = samples / "wls"
    reconstructed = [folder / "reconstructed" / f"{i}.ply" for i in ids_of(folder, "reconstructed")]
    generated = [folder / "generated" / f"{i}.ply" for i in ids_of(folder, "generated")]
    yield f"{name}\nreconstructed", row_of(map(surface_picture, reconstructed))
    yield f"{name}\nsampled", row_of(map(surface_picture, generated))
    yield f"{name}\ncut open", row_of(cut_picture(path.with_suffix(".vtu")) for path in generated)


def original_row(archives: list[str], wanted: list[str]):
    meshes = (mesh for archive in archives for mesh in read_meshes(Path(archive)) if mesh[0] in set(wanted))
    found = {shape_id: picture(vertices, faces) for shape_id, vertices, faces in islice(meshes, len(wanted))}
    return "validation\nshapes", row_of(found[shape_id] for shape_id in wanted)


def draw(samples: list[str], names: list[str], archives: list[str], out: str) -> None:
    wanted = ids_of(Path(samples[0]) / "wls", "reconstructed")
    rows = [original_row(archives, wanted)]
    for folder, name in zip(samples, names, strict=True):
        rows += model_rows(Path(folder), name)
    pictures = [cell for _, row in rows for cell in row]
    save_image(out, contact_sheet(pictures, COLUMNS, row_titles=[title for title, _ in rows]))


with Path(snakemake.log[0]).open("w") as log:
    sys.stdout = sys.stderr = log
    draw(
        list(snakemake.input.samples),
        list(snakemake.params.names),
        list(snakemake.input.meshes),
        snakemake.output.picture,
    )
