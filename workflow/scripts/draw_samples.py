"""Validation shapes beside their reconstructions, random samples, and samples cut open, on one sheet."""

from pathlib import Path

from tetgan.rendering.figure import Row, Shape, draw_rows
from tetgan.rendering.meshes import (
    CUT,
    CUT_AZIMUTH,
    cut_open,
    list_shapes,
    read_originals,
    read_shape,
)
from tetgan.rendering.sheet import save_image
from tetgan.rendering.view import View
from tetgan.solids.folder import finished_samples, sample_ids

Shown = list[tuple[str, str, str, Shape | None]]


def read_shown(folder: Path, name: str, kind: str, columns: int) -> Shown:
    """The first shapes of a model of one kind: reconstructed or generated."""
    ids = sample_ids(folder, kind, columns)
    return [(name, kind, i, read_shape(folder / kind / f"{i}.ply")) for i in ids]


def model_rows(folder: Path, name: str, reconstructed: Shown, generated: Shown) -> list[Row]:
    """Rows of one model: reconstructions, samples, samples cut open; all smoothed (Eq. 4)."""
    solids = [cut_open(folder / "generated" / f"{shape_id}.vtu", CUT) for _, _, shape_id, _ in generated]
    return [
        Row(f"{name}\nreconstructed", [shape for *_, shape in reconstructed], ruled=True),
        Row(f"{name}\nsampled", [shape for *_, shape in generated]),
        Row(f"{name}\ncut open", solids, azimuth=CUT_AZIMUTH),
    ]


def draw(samples: list[Path], names: list[str], archives: list[str], columns: int, out: Path) -> None:
    wanted = sample_ids(finished_samples(samples[0]), "reconstructed", columns)
    originals = read_originals(archives, wanted)
    rows = [Row("validation\nshapes", originals)]
    shown: Shown = [
        ("", "validation", shape_id, shape) for shape_id, shape in zip(wanted, originals, strict=True)
    ]
    for samples_of_model, name in zip(samples, names, strict=True):
        folder = finished_samples(samples_of_model)
        kinds = [read_shown(folder, name, kind, columns) for kind in ("reconstructed", "generated")]
        rows += model_rows(folder, name, *kinds)
        shown += [one for kind in kinds for one in kind]
    save_image(out, draw_rows(rows, View()))
    list_shapes(shown).to_csv(out.with_suffix(".csv"), index=False)


draw(
    [Path(folder) for folder in snakemake.input.samples],
    list(snakemake.params.names),
    list(snakemake.input.meshes),
    snakemake.params.columns,
    Path(snakemake.output.picture),
)
