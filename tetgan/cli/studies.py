"""Commands for the studies of the latent space, of resolution and of smoothing."""

from pathlib import Path
from typing import Annotated

import typer

from tetgan.cli.app import (
    OptionsText,
    Threads,
    app,
    limit_libigl,
    read_options,
    read_plain,
    split_ids,
    use_threads,
)

PANEL = "Studies"


@app.command(rich_help_panel=PANEL)
def interpolate(
    model: Annotated[Path, typer.Argument(help="Folder of a trained model.")],
    index: Annotated[Path, typer.Argument(help="Index of the fields it was trained on.")],
    folder: Annotated[Path, typer.Argument(help="Folder of meshes to write.")],
    pair: Annotated[list[str] | None, typer.Option(help="Ids of two shapes, A:B; may be repeated.")] = None,
    options: OptionsText = "{}",
    meshing: OptionsText = "{}",
) -> None:
    """Mesh the shapes between two shapes; without `--pair`, between random validation shapes.

    Writes a folder a pair with a surface (.ply) and a solid (.vtu) a step, and `steps.csv`.

    Example: `tetgan interpolate results/models/chair/tetgan-LR/0 results/fields/chair/LR/index.json between
    --pair chair-0003:chair-0017 --options '{steps: 9}'`
    """
    from tetgan.files import whole_folder
    from tetgan.meshing.options import MeshingOptions
    from tetgan.studies.latent.interpolation import STEPS, interpolate_shapes
    from tetgan.studies.options import LatentOptions

    chosen = read_options(LatentOptions, options, "--options")
    shape = read_options(MeshingOptions, meshing, "--meshing")
    pairs = [split_ids(text, 2, "--pair") for text in pair or []]
    with whole_folder(folder, STEPS) as partial:
        interpolate_shapes(model, index, partial, options=chosen, meshing=shape, pairs=pairs)


@app.command(rich_help_panel=PANEL)
def add_parts(
    model: Annotated[Path, typer.Argument(help="Folder of a trained model.")],
    index: Annotated[Path, typer.Argument(help="Index of the fields it was trained on.")],
    folder: Annotated[Path, typer.Argument(help="Folder of meshes to write.")],
    triple: Annotated[
        list[str] | None, typer.Option(help="Ids of three shapes, A:B:C; may be repeated.")
    ] = None,
    options: OptionsText = "{}",
    meshing: OptionsText = "{}",
) -> None:
    """Put the part that A has and B has not onto C; without `--triple`, on validation shapes chosen by rule.

    Writes a folder a triple with surfaces (.ply) and solids (.vtu) of A, B, C and D = A - B + C, the faces
    that changed (`changes.npz`), and `triples.csv`.

    Example: `tetgan add-parts results/models/chair/tetgan-LR/0 results/fields/chair/LR/index.json sums
    --triple chair-0003:chair-0017:chair-0021`
    """
    from tetgan.files import whole_folder
    from tetgan.meshing.options import MeshingOptions
    from tetgan.studies.latent.arithmetic import TRIPLES, add_parts
    from tetgan.studies.options import LatentOptions

    chosen = read_options(LatentOptions, options, "--options")
    shape = read_options(MeshingOptions, meshing, "--meshing")
    triples = [split_ids(text, 3, "--triple") for text in triple or []]
    with whole_folder(folder, TRIPLES) as partial:
        add_parts(model, index, partial, options=chosen, meshing=shape, triples=triples)


@app.command(rich_help_panel=PANEL)
def find_nearest(
    meshes: Annotated[list[Path], typer.Argument(help="Zips of repaired meshes.")],
    out: Annotated[Path, typer.Argument(help="Table (.csv) to write.")],
    catalogue: Annotated[Path, typer.Option(help="Catalogue that holds the split.")],
    samples: Annotated[
        Path | None, typer.Option(help="Folder of meshes, or one written by `tetgan sample`.")
    ] = None,
    options: OptionsText = "{}",
    threads: Threads = 1,
) -> None:
    """Find the training shape nearest to every sample; without `--samples`, to every validation shape.

    Example: `tetgan find-nearest chairs.zip nearest.csv --catalogue catalogue.csv --samples samples`
    """
    from tetgan.studies.latent.nearest import find_nearest_shapes
    from tetgan.studies.options import NearestOptions

    chosen = read_options(NearestOptions, options, "--options")
    find_nearest_shapes(meshes, catalogue, out, samples=samples, options=chosen, threads=threads)


@app.command(rich_help_panel=PANEL)
def measure_resolution(
    table: Annotated[Path, typer.Argument(help="Table (.csv) to write; with a .md twin.")],
    figure: Annotated[Path, typer.Argument(help="Figure (.png) to write; with its data beside it.")],
    options: OptionsText = "{}",
    threads: Threads = 1,
) -> None:
    """Measure how fine tets and voxels must be to represent a torus equally well.

    Example: `tetgan measure-resolution tables/resolution.csv figures/resolution.png`
    """
    limit_libigl(threads)
    from tetgan.studies.options import ResolutionOptions
    from tetgan.studies.resolution.study import measure_resolution

    measure_resolution(read_options(ResolutionOptions, options, "--options"), table, figure)


@app.command(rich_help_panel=PANEL)
def measure_smoothing(
    model: Annotated[Path, typer.Argument(help="Folder of a trained model.")],
    index: Annotated[Path, typer.Argument(help="Index of the fields it was trained on.")],
    folder: Annotated[Path, typer.Argument(help="Folder of figures to write.")],
    meshes: Annotated[list[Path], typer.Argument(help="Zips of repaired meshes, the reference.")],
    clouds: Annotated[Path, typer.Option(help="Point clouds with the hold-out surfaces.")],
    extractor: Annotated[Path, typer.Option(help="Folder of the trained classifier.")],
    identity: OptionsText = "{}",
    options: OptionsText = "{}",
    meshing: OptionsText = "{}",
    evaluation: OptionsText = "{}",
    threads: Threads = 1,
) -> None:
    """Measure what displacement and each smoothing do to the surfaces of a model.

    Example: `tetgan measure-smoothing models/chair/representation-LR/0 index.json study chairs.zip
    --clouds chair.npz --extractor extractor`
    """
    limit_libigl(threads)
    from tetgan.evaluation.options import EvaluationOptions
    from tetgan.meshing.options import MeshingOptions
    from tetgan.studies.options import SmoothingOptions
    from tetgan.studies.smoothing.study import measure_smoothing

    use_threads(threads)
    measure_smoothing(
        model,
        index,
        folder,
        meshes=meshes,
        clouds=clouds,
        extractor=extractor,
        study=read_options(SmoothingOptions, options, "--options"),
        meshing=read_options(MeshingOptions, meshing, "--meshing"),
        evaluation=read_options(EvaluationOptions, evaluation, "--evaluation"),
        identity=read_plain(identity, "--identity"),
    )


@app.command(rich_help_panel=PANEL)
def tabulate_smoothing(
    studies: Annotated[list[Path], typer.Argument(help="Folders written by `tetgan measure-smoothing`.")],
    out: Annotated[Path, typer.Argument(help="Table (.csv) to write; with a .md twin.")],
) -> None:
    """Set the smoothing studies side by side, and weigh the paper's claims.

    Example: `tetgan tabulate-smoothing studies/chair/* smoothing.csv`
    """
    from tetgan.studies.smoothing.table import tabulate_smoothing

    tabulate_smoothing(studies, out)
