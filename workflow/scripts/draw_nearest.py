"""Samples above their nearest training shapes, from the most remembered to the newest."""

from pathlib import Path

import numpy as np
import pandas as pd

from tetgan.rendering.figure import Row, draw_rows
from tetgan.rendering.meshes import read_originals, read_shape
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View
from tetgan.solids.folder import finished_samples

REAL = "real"


def read_tables(paths: list[str], names: list[str]) -> pd.DataFrame:
    read = (pd.read_csv(path, dtype={"id": str, "nearest": str}) for path in paths)
    return pd.concat([table.assign(model=name) for name, table in zip(names, read, strict=True)])


def spread(table: pd.DataFrame, count: int) -> pd.DataFrame:
    """Rows evenly over the order of the distances, the smallest and the largest included."""
    ranked = table.dropna(subset=["chamfer"]).sort_values(["chamfer", "id"])
    places = np.linspace(0, len(ranked) - 1, min(count, len(ranked))).round().astype(int)
    return ranked.iloc[places]


def pair_rows(folder: Path, title: str, table: pd.DataFrame, archives: list[str]) -> list[Row]:
    samples = [read_shape(folder / "generated" / f"{shape_id}.ply") for shape_id in table["id"]]
    distances = [f"{1000 * distance:.1f}" for distance in table["chamfer"]]
    return [
        Row(title, samples, distances, ruled=True),
        Row("nearest\ntraining\nshape", read_originals(archives, table["nearest"].tolist())),
    ]


def draw(samples: dict[str, Path], table: pd.DataFrame, archives: list[str], columns: int, out: Path) -> None:
    medians = 1000 * table.groupby("model")["chamfer"].median()
    rows = []
    for name, folder in samples.items():
        title = f"{name}\nmedian {medians[name]:.1f}\n(held-out {medians[REAL]:.1f})"
        chosen = spread(table[table["model"] == name], columns)
        rows += pair_rows(finished_samples(folder), title, chosen, archives)
    save_image(out, draw_rows(rows, View()))
    table.to_csv(out.with_suffix(".csv"), index=False)


names = list(snakemake.params.names)
draw(
    dict(zip(names, map(Path, snakemake.input.samples), strict=True)),
    read_tables([*snakemake.input.tables, snakemake.input.real], [*names, REAL]),
    list(snakemake.input.meshes),
    snakemake.params.columns,
    Path(snakemake.output.picture),
)
