"""Figure of latent arithmetic, A - B + C = D, with changed parts in colour."""

from pathlib import Path

import numpy as np
import pandas as pd

from tetgan.rendering.figure import Row, Shape, draw_rows
from tetgan.rendering.meshes import read_shape
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View

# Linear RGB of a changed part: purple, amber, pink and green, as in the paper's figure; the rest is grey.
CHANGED = {"A": (0.20, 0.03, 0.55), "B": (0.95, 0.50, 0.04), "C": (0.85, 0.13, 0.34), "D": (0.07, 0.55, 0.16)}
PLAIN = (0.52, 0.54, 0.57)
TITLES = {"A": "A", "B": "- B", "C": "+ C", "D": "= D"}


def coloured(folder: Path, letter: str) -> Shape | None:
    shape = read_shape(folder / f"{letter}.ply")
    if shape is None:
        return None
    with np.load(folder / "changes.npz") as changes:
        colors = np.where(changes[letter][:, None], np.array(CHANGED[letter]), np.array(PLAIN))
    return Shape(shape.vertices, shape.faces, colors)


def ink(letter: str) -> tuple[int, int, int]:
    red, green, blue = (round(255 * part ** (1 / 2.2)) for part in CHANGED[letter])
    return red, green, blue


def triple_row(folder: Path, name: str, triple: pd.Series) -> Row:
    """Four shapes; under C and D, how much of the part they have."""
    shapes = [coloured(folder / triple["triple"], letter) for letter in TITLES]
    gained = f"part {triple['part_in_c']:.0%} to {triple['part_in_d']:.0%}"
    return Row(name, shapes, [*triple[["a", "b", "c"]], gained], ruled=True)


def draw(folders: list[Path], names: list[str], out: Path) -> None:
    tables = [pd.read_csv(folder / "triples.csv", dtype=dict.fromkeys("abc", str)) for folder in folders]
    rows = [
        triple_row(folder, name, triple)
        for folder, name, table in zip(folders, names, tables, strict=True)
        for _, triple in table.iterrows()
    ]
    inks = [ink(letter) for letter in TITLES]
    save_image(out, draw_rows(rows, View(size=(360, 360)), list(TITLES.values()), inks))
    data = pd.concat([table.assign(model=name) for name, table in zip(names, tables, strict=True)])
    data.to_csv(out.with_suffix(".csv"), index=False)


draw(
    [Path(folder) for folder in snakemake.input.folders],
    list(snakemake.params.names),
    Path(snakemake.output.picture),
)
