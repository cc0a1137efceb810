"""Samples cut open by a plane at several places: they are solid inside."""

import sys
from pathlib import Path

import pandas as pd
from tetgan.studies.voids import count_voids

from tetgan.rendering.figure import Row, Shape, draw_rows
from tetgan.rendering.meshes import CUT_AZIMUTH, cut_open, finished_samples, read_shape, read_solid
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View

NORMAL = (1.0, 0.0, 0.0)
SHARES = (0.8, 0.65, 0.5, 0.35, 0.2)  # position of the plane along the shape
FIRST, SHOWN = 16, 3  # of the first samples those with the most tets: they have an inside to look into


def chosen(folder: Path) -> list[str]:
    table = pd.read_csv(folder / "certificate.csv", dtype={"id": str})
    first = table[table["set"] == "generated"].head(FIRST)
    return first.sort_values(["tets", "id"], ascending=[False, True])["id"].tolist()[:SHOWN]


def solid_row(path: Path, title: str, surface: Shape | None) -> Row:
    solid = read_solid(path.with_suffix(".vtu"))
    cuts = [cut_open(solid, NORMAL, share) for share in SHARES]
    return Row(title, [surface, *cuts], azimuth=CUT_AZIMUTH)


def draw(samples: list[Path], names: list[str], out: Path) -> None:
    rows, shown = [], []
    for folder, name in zip(map(finished_samples, samples), names, strict=True):
        for shape_id in chosen(folder):
            path = folder / "generated" / f"{shape_id}.ply"
            surface = read_shape(path)
            rows.append(solid_row(path, f"{name}\nsample {shape_id}", surface))
            voids = None if surface is None else count_voids(surface.vertices, surface.faces)
            shown.append((name, folder.name, shape_id, voids))
    titles = ["whole", *(f"cut at {share:.0%}" for share in SHARES)]
    save_image(out, draw_rows(rows, View(size=(320, 320)), titles))
    data = pd.DataFrame(shown, columns=["model", "smoothing", "id", "voids"])
    data.to_csv(out.with_suffix(".csv"), index=False)


with Path(snakemake.log[0]).open("w") as log:
    sys.stdout = sys.stderr = log
    draw(
        [Path(folder) for folder in snakemake.input.samples],
        list(snakemake.params.names),
        Path(snakemake.output.picture),
    )
