"""One validation shape in every variant of displacement and smoothing, whole and enlarged, for each model."""

from pathlib import Path

import numpy as np
import pandas as pd

from tetgan.rendering.raycast import render_mesh
from tetgan.rendering.sheet import contact_sheet, save_image
from tetgan.shapes.archive import read_meshes
from tetgan.studies.smoothing.files import EXAMPLE, REPAIRED, VARIANTS, Variant, read_study
from tetgan.studies.smoothing.rows import measure_bends

CELL = 300
ENLARGED = 3
FRAME = 6  # pixels of white around an enlarged window
# Corner of the enlarged window in the enlarged picture, in cells: about where a seat meets its back and legs.
WINDOW = (0.9, 1.2)
BEND = 10  # degrees of a bar of the histogram in the data
NAMES = {"none": "", "wls": "wLS", "uniform": "plain", "cotangent": "cotangent"}


def whole(vertices, faces):
    return render_mesh(vertices, faces, size=(CELL, CELL), span=1.3)


def enlarged(vertices, faces):
    side = ENLARGED * CELL
    picture = render_mesh(vertices, faces, size=(side, side), span=1.3)
    top, left = (round(CELL * place) for place in WINDOW)
    window = picture[top : top + CELL - 2 * FRAME, left : left + CELL - 2 * FRAME]
    return np.pad(window, ((FRAME, FRAME), (FRAME, FRAME), (0, 0)), constant_values=255)


def columns():
    """Name in the archive and title of every column."""
    yield REPAIRED, "repaired shape"
    for variant in VARIANTS:
        base = "displaced" if variant.displaced else "blocky"
        yield variant.name, " + ".join(filter(None, [base, NAMES[variant.smoothing]]))


def measured(study: str, model: str, shapes: dict) -> pd.DataFrame:
    """Figures of the first shape and the bends of its edges: one row per column of the picture."""
    rows = read_study(Path(study)).rows
    rows = rows[rows["id"] == rows["id"].iloc[0]].assign(model=model).reset_index(drop=True)
    names = [
        REPAIRED if smoothing == REPAIRED else Variant(displaced, smoothing).name
        for displaced, smoothing in zip(rows["displaced"], rows["smoothing"], strict=True)
    ]
    return rows.join(pd.DataFrame([measure_bends(*shapes[name]).histogram(BEND) for name in names]))


def draw(studies: list[str], models: list[str], out: Path) -> None:
    pictures, rows, data = [], [], []
    for study, model in zip(studies, models, strict=True):
        shapes = {name: (vertices, faces) for name, vertices, faces in read_meshes(Path(study) / EXAMPLE)}
        for view in (whole, enlarged):
            pictures += [view(*shapes[name]) for name, _ in columns()]
        rows += [model, "enlarged"]
        data.append(measured(study, model, shapes))
    titles = [title for _, title in columns()]
    save_image(out, contact_sheet(pictures, len(titles), titles=titles * len(rows), row_titles=rows))
    pd.concat(data).to_csv(out.with_suffix(".csv"), index=False)


draw(list(snakemake.input.studies), list(snakemake.params.names), Path(snakemake.output.picture))
