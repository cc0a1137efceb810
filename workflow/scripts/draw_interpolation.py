"""Interpolations between pairs of shapes: for each model and pair the steps, and below them cut open."""

from pathlib import Path

import pandas as pd

from tetgan.rendering.figure import NOTHING, Row, draw_rows
from tetgan.rendering.meshes import CUT, CUT_AZIMUTH, cut_open, read_originals, read_shape
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View


def captions(steps: pd.DataFrame) -> list[str]:
    """Chamfer distance to the step before, in thousandths, and the volume."""
    moved = [f"CD {1000 * value:.1f}\n" if value >= 0 else "" for value in steps["chamfer_step"]]
    return [f"{cd}V {volume:.3f}" for cd, volume in zip(moved, steps["volume"], strict=True)]


def pair_rows(folder: Path, name: str, steps: pd.DataFrame, archives: list[str]) -> list[Row]:
    """Both shapes at the ends, the decoded steps between them."""
    first, second = read_originals(archives, [steps["first"].iloc[0], steps["second"].iloc[0]])
    paths = [folder / steps["pair"].iloc[0] / f"{step}.ply" for step in steps["id"]]
    cut = [cut_open(path.with_suffix(".vtu"), CUT) for path in paths]
    return [
        Row(name, [first, *map(read_shape, paths), second], ["", *captions(steps)], ruled=True),
        Row("cut open", [NOTHING, *cut, NOTHING], azimuth=CUT_AZIMUTH),
    ]


def draw(folders: list[Path], names: list[str], archives: list[str], out: Path) -> None:
    tables = [pd.read_csv(folder / "steps.csv", dtype={"id": str}) for folder in folders]
    rows = [
        row
        for folder, name, table in zip(folders, names, tables, strict=True)
        for _, steps in table.groupby("pair", sort=False)
        for row in pair_rows(folder, name, steps, archives)
    ]
    times = [f"t = {t:.2g}" for t in tables[0]["t"].unique()]
    save_image(out, draw_rows(rows, View(size=(260, 260)), column_titles=["shape A", *times, "shape B"]))
    data = pd.concat([table.assign(model=name) for name, table in zip(names, tables, strict=True)])
    data.to_csv(out.with_suffix(".csv"), index=False)


draw(
    [Path(folder) for folder in snakemake.input.folders],
    list(snakemake.params.names),
    list(snakemake.input.meshes),
    Path(snakemake.output.picture),
)
