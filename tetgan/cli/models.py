"""Commands for training, sampling and packing models."""

from pathlib import Path
from typing import Annotated

import typer

from tetgan.cli.app import OptionsText, Seed, Threads, app, read_options, read_plain, use_threads

PANEL = "Models"


@app.command(rich_help_panel=PANEL)
def train(
    index: Annotated[Path, typer.Argument(help="Index of the fields, or of a baseline's points or voxels.")],
    folder: Annotated[Path, typer.Argument(help="Folder of the trained model; training resumes in it.")],
    model: OptionsText,
    training: OptionsText = "{}",
    seed: Seed = 0,
    threads: Threads = 2,
    of: Annotated[
        Path | None,
        typer.Option(help="Folder of the trained model that this one is built on: a TetGAN for a `deftet`."),
    ] = None,
    processes: Annotated[
        int, typer.Option(min=0, help="Processes, each with a GPU, that share a TetGAN's batches; 0 means 1.")
    ] = 1,
) -> None:
    """Train a model on the shapes of one category; run again, it goes on where it was stopped.

    Example: `tetgan train index.json model --model '{kind: tetgan, grid: LR, width: 16, code: 32}'`
    """
    from tetgan.models.registry import ModelOptions, method_of
    from tetgan.training.processes import relaunch
    from tetgan.training.run import train_model
    from tetgan.training.sections import training_class

    chosen = read_options(ModelOptions, model, "--model")
    options = read_options(training_class(chosen), training, "--training")
    if method_of(chosen).shares_batches:
        relaunch(processes)
    use_threads(threads)
    train_model(index, chosen, options, seed, folder, of=of)


@app.command(rich_help_panel=PANEL)
def train_extractor(
    clouds: Annotated[list[Path], typer.Argument(help="Point clouds, one file a category.")],
    folder: Annotated[Path, typer.Argument(help="Folder of the trained classifier.")],
    options: OptionsText = "{}",
    threads: Threads = 2,
) -> None:
    """Train the PointNet++ classifier whose features FID and KID compare.

    Example: `tetgan train-extractor chair.npz sofa.npz extractor`
    """
    from tetgan.evaluation.extractor import train_extractor
    from tetgan.extractor.options import ExtractorOptions

    use_threads(threads)
    train_extractor(
        clouds, [cloud.stem for cloud in clouds], read_options(ExtractorOptions, options, "--options"), folder
    )


@app.command(rich_help_panel=PANEL)
def sample(
    model: Annotated[
        Path, typer.Argument(help="Folder of a trained model, or the name of a pretrained one: chair.")
    ],
    folder: Annotated[Path, typer.Argument(help="Folder of meshes to write.")],
    index: Annotated[
        Path | None,
        typer.Option(
            help="Index of the fields, points or voxels it was trained on; a packed model needs none."
        ),
    ] = None,
    count: Annotated[int, typer.Option(min=1, help="Shapes to generate.")] = 16,
    mode: Annotated[str, typer.Option(help="How solids are built: solid (valid), or paper.")] = "solid",
    options: OptionsText = "{}",
    seed: Seed = 0,
    threads: Threads = 1,
) -> None:
    """Generate meshes, and reconstruct the validation shapes of the index.

    Writes `none/` and `wls/` (without and with smoothing), each with `generated/` and `reconstructed/`
    surfaces (.ply) and solids (.vtu), and `certificate.csv` with the quality of every mesh. Models of
    implicit surfaces have neither solids nor smoothing, and a GAN reconstructs nothing.

    Example: `tetgan sample chair chairs --count 8`, or of a model of your own
    `tetgan sample results/models/chair/tetgan-LR/0 chairs --index results/fields/chair/LR/index.json`
    """
    from tetgan.files import whole_folder
    from tetgan.meshing.options import MeshingOptions
    from tetgan.models.pack import find_model, index_beside
    from tetgan.models.samples import sample_model
    from tetgan.solids.folder import CERTIFICATES

    chosen = MeshingOptions.parse(read_plain(options, "--options") | {"mode": mode}, "sample")
    found = find_model(model)
    learned_from = index or index_beside(found)
    use_threads(threads)
    with whole_folder(folder, CERTIFICATES) as partial:
        sample_model(found, learned_from, partial, count=count, options=chosen, seed=seed)


@app.command(rich_help_panel=PANEL)
def pack(
    model: Annotated[Path, typer.Argument(help="Folder of a trained model of fields.")],
    index: Annotated[Path, typer.Argument(help="Index of the fields it was trained on.")],
    folder: Annotated[Path, typer.Argument(help="Folder to write.")],
) -> None:
    """Make a small copy of a trained model that samples without its fields, to hand on.

    Example: `tetgan pack results/models/chair/tetgan-LR/0 results/fields/chair/LR/index.json my-chairs`
    """
    from tetgan.models.pack import pack_model

    pack_model(model, index, folder)


@app.command(rich_help_panel=PANEL)
def simplify(
    samples: Annotated[Path, typer.Argument(help="Folder written by `tetgan sample`.")],
    folder: Annotated[Path, typer.Argument(help="Folder of simplified meshes to write.")],
    faces: Annotated[int, typer.Option(min=4, help="Most faces of a mesh.")] = 5500,
) -> None:
    """Take faces away from a model's samples by quadric edge collapse.

    Example: `tetgan simplify chairs chairs-simplified --faces 5500`
    """
    from tetgan.files import whole_folder
    from tetgan.meshing.simplify import simplify_samples
    from tetgan.shapes.options import SimplifyOptions
    from tetgan.solids.folder import CERTIFICATES

    with whole_folder(folder, CERTIFICATES) as partial:
        simplify_samples(samples, partial, SimplifyOptions(faces=faces))
