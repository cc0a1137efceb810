"""The same number of unselected samples of every model, one row per model, real shapes on top."""

from pathlib import Path

import pandas as pd

from tetgan.rendering.figure import Row, draw_rows
from tetgan.rendering.meshes import read_originals, read_shape
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View
from tetgan.solids.folder import finished_samples, sample_ids

REAL = "real"


def model_table(samples: Path, name: str, columns: int) -> pd.DataFrame:
    """The first samples of a model, those that came out empty included."""
    folder = finished_samples(samples)
    ids = sample_ids(folder, "generated", columns)
    shapes = [read_shape(folder / "generated" / f"{shape_id}.ply") for shape_id in ids]
    return pd.DataFrame({"model": name, "smoothing": folder.name, "id": ids, "shape": shapes})


def real_table(samples: Path, archives: list[str], columns: int) -> pd.DataFrame:
    ids = sample_ids(finished_samples(samples), "reconstructed", columns)
    return pd.DataFrame({"model": REAL, "smoothing": "", "id": ids, "shape": read_originals(archives, ids)})


def model_row(name: str, table: pd.DataFrame) -> Row:
    mean = table.loc[table["faces"] > 0, "faces"].mean()
    faces = f"{mean:,.0f} faces" if mean > 0 else "no faces"
    return Row(f"{name}\n{faces}", table["shape"].tolist(), ruled=name != REAL)


def draw(samples: list[Path], names: list[str], archives: list[str], columns: int, out: Path) -> None:
    tables = [model_table(folder, name, columns) for folder, name in zip(samples, names, strict=True)]
    table = pd.concat([real_table(samples[0], archives, columns), *tables])
    table["faces"] = [0 if shape is None else len(shape.faces) for shape in table["shape"]]
    rows = [model_row(str(name), part) for name, part in table.groupby("model", sort=False)]
    save_image(out, draw_rows(rows, View(size=(260, 260))))
    table.drop(columns="shape").to_csv(out.with_suffix(".csv"), index=False)


draw(
    [Path(folder) for folder in snakemake.input.samples],
    list(snakemake.params.names),
    list(snakemake.input.meshes),
    snakemake.params.columns,
    Path(snakemake.output.picture),
)
