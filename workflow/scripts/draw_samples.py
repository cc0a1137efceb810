"""Validation shapes beside their reconstructions, random samples, and samples cut open, on one sheet."""

import sys
from pathlib import Path

import pandas as pd

from tetgan.rendering.figure import Row, draw_rows
from tetgan.rendering.meshes import (
    CUT,
    CUT_AZIMUTH,
    cut_open,
    finished_samples,
    read_originals,
    read_shape,
    read_solid,
    sample_ids,
)
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View


def model_rows(samples: Path, name: str, columns: int) -> list[Row]:
    """Rows of one model: reconstructions, samples, samples cut open; all smoothed (Eq. 4)."""
    folder = finished_samples(samples)
    reconstructed, generated = (
        [folder / kind / f"{shape_id}.ply" for shape_id in sample_ids(folder, kind, columns)]
        for kind in ("reconstructed", "generated")
    )
    solids = [read_solid(path.with_suffix(".vtu")) for path in generated]
    return [
        Row(f"{name}\nreconstructed", [read_shape(path) for path in reconstructed], ruled=True),
        Row(f"{name}\nsampled", [read_shape(path) for path in generated]),
        Row(f"{name}\ncut open", [cut_open(solid, CUT) for solid in solids], azimuth=CUT_AZIMUTH),
    ]


def draw(samples: list[Path], names: list[str], archives: list[str], columns: int, out: Path) -> None:
    wanted = sample_ids(finished_samples(samples[0]), "reconstructed", columns)
    rows = [Row("validation\nshapes", read_originals(archives, wanted))]
    shown = []
    for folder, name in zip(samples, names, strict=True):
        rows += model_rows(folder, name, columns)
        shown += [(name, "generated", i) for i in sample_ids(finished_samples(folder), "generated", columns)]
    shown += [("", "validation", shape_id) for shape_id in wanted]
    save_image(out, draw_rows(rows, View()))
    pd.DataFrame(shown, columns=["model", "set", "id"]).to_csv(out.with_suffix(".csv"), index=False)


with Path(snakemake.log[0]).open("w") as log:
    sys.stdout = sys.stderr = log
    draw(
        [Path(folder) for folder in snakemake.input.samples],
        list(snakemake.params.names),
        list(snakemake.input.meshes),
        snakemake.params.columns,
        Path(snakemake.output.picture),
    )
