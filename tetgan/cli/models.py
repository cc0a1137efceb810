"""Training, and meshes out of trained models."""

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
        Path | None, typer.Option(help="Folder of the trained TetGAN that a `deftet` stands on.")
    ] = None,
) -> None:
    """Train a model on the shapes of one category; run again, it goes on where it was stopped.

    Example: `tetgan train index.json model --model '{kind: tetgan, grid: LR, width: 16, code: 32}'`
    """
    from tetgan.models.options import ModelOptions
    from tetgan.training.kinds import training_class
    from tetgan.training.trainer import train_model

    use_threads(threads)
    chosen = read_options(ModelOptions, model, "--model")
    options = read_options(training_class(chosen), training, "--training")
    train_model(index, chosen, options, seed, folder, of=of)


@app.command(rich_help_panel=PANEL)
def extractor(
    clouds: Annotated[list[Path], typer.Argument(help="Point clouds, one file a category.")],
    folder: Annotated[Path, typer.Argument(help="Folder of the trained classifier.")],
    options: OptionsText = "{}",
    threads: Threads = 2,
) -> None:
    """Train the PointNet++ classifier whose features FID and KID compare.

    Example: `tetgan extractor chair.npz sofa.npz extractor`
    """
    from tetgan.evaluation.extractor import train_extractor
    from tetgan.training.extractor_options import ExtractorOptions

    use_threads(threads)
    train_extractor(
        clouds, [cloud.stem for cloud in clouds], read_options(ExtractorOptions, options, "--options"), folder
    )


@app.command(rich_help_panel=PANEL)
def sample(
    model: Annotated[Path, typer.Argument(help="Folder of a trained model.")],
    index: Annotated[Path, typer.Argument(help="Index of the fields, points or voxels it was trained on.")],
    folder: Annotated[Path, typer.Argument(help="Folder of meshes to write.")],
    count: Annotated[int, typer.Option(min=1, help="Shapes to generate.")] = 16,
    mode: Annotated[str, typer.Option(help="How solids are built: solid (valid), or paper.")] = "solid",
    options: OptionsText = "{}",
    seed: Seed = 0,
    threads: Threads = 1,
) -> None:
    """Generate meshes, and reconstruct the validation shapes.

    Writes `none/` and `wls/` (without and with smoothing), each with `generated/` and `reconstructed/`
    surfaces (.ply) and solids (.vtu), and `certificate.csv` with the quality of every mesh. Models of
    implicit surfaces have neither solids nor smoothing, and a GAN reconstructs nothing.

    Example: `tetgan sample results/models/chair/tetgan-LR/0 results/fields/chair/LR/index.json chairs`
    """
    from tetgan.files import whole_folder
    from tetgan.meshing.options import MeshingOptions
    from tetgan.models.samples import write_samples

    chosen = MeshingOptions.parse(read_plain(options, "--options") | {"mode": mode}, "sample")
    use_threads(threads)
    with whole_folder(folder) as partial:
        write_samples(model, index, partial, count=count, options=chosen, seed=seed)


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

    with whole_folder(folder) as partial:
        simplify_samples(samples, partial, SimplifyOptions(faces=faces))
