"""Figure of the ablation: one row per model, reconstructed validation shapes, then samples."""

from pathlib import Path

from tetgan.rendering.figure import NOTHING, Row, draw_rows
from tetgan.rendering.meshes import list_shapes, read_originals, read_shape
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View
from tetgan.solids.folder import finished_samples, sample_ids

EACH = 4  # shapes of either kind


def draw(samples: list[Path], names: list[str], archives: list[str], out: Path) -> None:
    folders = [finished_samples(folder) for folder in samples]
    wanted = sample_ids(folders[0], "reconstructed", EACH)
    originals = read_originals(archives, wanted)
    rows = [Row("validation\nshapes", [*originals, *EACH * [NOTHING]])]
    shown = [("", "validation", shape_id, shape) for shape_id, shape in zip(wanted, originals, strict=True)]
    for folder, name in zip(folders, names, strict=True):
        ids = [("reconstructed", i) for i in wanted]
        ids += [("generated", i) for i in sample_ids(folder, "generated", EACH)]
        own = [(name, kind, i, read_shape(folder / kind / f"{i}.ply")) for kind, i in ids]
        rows.append(Row(name, [shape for *_, shape in own]))
        shown += own
    titles = EACH * ["reconstruction"] + EACH * ["sample"]
    save_image(out, draw_rows(rows, View(size=(220, 220)), column_titles=titles))
    list_shapes(shown).to_csv(out.with_suffix(".csv"), index=False)


draw(
    [Path(folder) for folder in snakemake.input.samples],
    list(snakemake.params.names),
    list(snakemake.input.meshes),
    Path(snakemake.output.picture),
)
