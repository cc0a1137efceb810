"""Samples cut open by a plane at several places: they are solid inside."""

from pathlib import Path

import pandas as pd

from tetgan.rendering.figure import Row, Shape, draw_rows
from tetgan.rendering.meshes import CUT_AZIMUTH, cut_open, read_shape
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View
from tetgan.solids.folder import finished_samples, read_certificates

NORMAL = (1.0, 0.0, 0.0)
SHARES = (0.8, 0.65, 0.5, 0.35, 0.2)  # position of the plane along the shape
FIRST, SHOWN = 16, 3  # of the first samples those with the most tets: they have an inside to look into


def chosen(folder: Path) -> pd.DataFrame:
    table = read_certificates(folder)
    assert table is not None, f"{folder}: not certified"
    first = table[table["set"] == "generated"].head(FIRST)
    return first.sort_values(["tets", "id"], ascending=[False, True]).head(SHOWN)


def solid_row(path: Path, title: str, surface: Shape | None) -> Row:
    cuts = [cut_open(path.with_suffix(".vtu"), NORMAL, share) for share in SHARES]
    return Row(title, [surface, *cuts], azimuth=CUT_AZIMUTH)


def draw(samples: list[Path], names: list[str], out: Path) -> None:
    rows, shown = [], []
    for folder, name in zip(map(finished_samples, samples), names, strict=True):
        solids = chosen(folder)
        for shape_id in solids["id"]:
            path = folder / "generated" / f"{shape_id}.ply"
            rows.append(solid_row(path, f"{name}\nsample {shape_id}", read_shape(path)))
        shown.append(solids[["id", "cavities"]].assign(model=name, smoothing=folder.name))
    titles = ["whole", *(f"cut at {share:.0%}" for share in SHARES)]
    save_image(out, draw_rows(rows, View(size=(320, 320)), titles))
    data = pd.concat(shown)[["model", "smoothing", "id", "cavities"]]
    data.to_csv(out.with_suffix(".csv"), index=False)


draw(
    [Path(folder) for folder in snakemake.input.samples],
    list(snakemake.params.names),
    Path(snakemake.output.picture),
)
