"""A row a model: validation shapes as it reconstructs them, then its samples, as in the paper's figure."""

import sys
from pathlib import Path

import pandas as pd

from tetgan.rendering.figure import NOTHING, Row, draw_rows
from tetgan.rendering.meshes import finished_samples, read_originals, read_shape, sample_ids
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View

EACH = 4  # shapes of either kind


def draw(samples: list[Path], names: list[str], archives: list[str], out: Path) -> None:
    folders = [finished_samples(folder) for folder in samples]
    wanted = sample_ids(folders[0], "reconstructed", EACH)
    rows = [Row("validation\nshapes", [*read_originals(archives, wanted), *EACH * [NOTHING]])]
    shown = [("", "validation", shape_id) for shape_id in wanted]
    for folder, name in zip(folders, names, strict=True):
        ids = [("reconstructed", i) for i in wanted]
        ids += [("generated", i) for i in sample_ids(folder, "generated", EACH)]
        rows.append(Row(name, [read_shape(folder / kind / f"{i}.ply") for kind, i in ids]))
        shown += [(name, kind, i) for kind, i in ids]
    titles = EACH * ["reconstruction"] + EACH * ["sample"]
    save_image(out, draw_rows(rows, View(size=(220, 220)), column_titles=titles))
    pd.DataFrame(shown, columns=["model", "set", "id"]).to_csv(out.with_suffix(".csv"), index=False)


with Path(snakemake.log[0]).open("w") as log:
    sys.stdout = sys.stderr = log
    draw(
        [Path(folder) for folder in snakemake.input.samples],
        list(snakemake.params.names),
        list(snakemake.input.meshes),
        Path(snakemake.output.picture),
    )
