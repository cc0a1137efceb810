"""The `tetgan` command: one subcommand a stage. Each reads files, calls one function, writes files.

Heavy libraries are imported inside the commands, so that `--help` answers at once.
"""

import logging
import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
import yaml

from tetgan.errors import UserError
from tetgan.options import parse_options

app = typer.Typer(
    help="Learned tetrahedral mesh generation, one stage a command.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)

OptionsText = Annotated[str, typer.Option(help="Options as JSON, or the path of a YAML or JSON file.")]
Category = Annotated[str, typer.Option(help="Category, such as chair.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed of every random choice.")]
Threads = Annotated[int, typer.Option(min=1, help="Processor cores to use.")]
Margin = Annotated[float, typer.Option(min=0, max=0.49, help="Empty share of the cube on either side.")]


def main() -> None:
    """Entry point: errors a person can act on are one line, everything else is a bug and shows itself."""
    logging.basicConfig(level=logging.INFO, format="%(levelname).1s %(name)s: %(message)s")
    try:
        app()
    except UserError as error:
        sys.exit(_complain(str(error)))
    except OSError as error:
        sys.exit(_complain(f"{error.filename or 'file'}: {error.strerror or error}"))


def _complain(message: str) -> int:
    print(f"error: {' '.join(message.split())}", file=sys.stderr)
    return 2


def _plain(text: str, name: str) -> dict[str, Any]:
    """A mapping from JSON text or from a YAML or JSON file."""
    source = text
    if not text.lstrip().startswith("{"):
        if not Path(text).is_file():
            raise UserError(f"{name}: '{text}' is neither a JSON object nor a file")
        source = Path(text).read_text()
    try:
        values = yaml.safe_load(source)
    except yaml.YAMLError as error:
        raise UserError(f"{name}: not valid YAML or JSON: {error}") from None
    if not isinstance(values, dict):
        raise UserError(f"{name}: expected keys and values, got {values!r}")
    return values


def _options(kind: Any, text: str, name: str) -> Any:
    return parse_options(kind, _plain(text, name), name)


def _use_threads(count: int) -> None:
    import torch

    from tetgan.training.memory import keep_freed_memory

    keep_freed_memory()
    torch.set_num_threads(count)


@app.command()
def repair(
    out: Annotated[Path, typer.Argument(help="Zip of repaired meshes to write.")],
    category: Category,
    source: OptionsText,
    options: OptionsText = "{}",
    margin: Margin = 0.02,
    shard: Annotated[str, typer.Option(help="Which part of the shapes: 3-of-16.")] = "1-of-1",
) -> None:
    """Make the shapes of a source watertight and fit them into the unit cube.

    Example: `tetgan repair chairs.zip --category chair --source '{kind: directory, path: my/chairs}'`
    """
    from tetgan.shapes.options import RepairOptions, SourceOptions
    from tetgan.shapes.shards import repair_shard

    repair_shard(
        category,
        _options(SourceOptions, source, "--source"),
        _options(RepairOptions, options, "--options"),
        margin=margin,
        shard=shard,
        out=out,
    )


@app.command()
def catalogue(
    shards: Annotated[list[Path], typer.Argument(help="Zips written by `tetgan repair`.")],
    out: Annotated[Path, typer.Argument(help="Catalogue (.csv) to write.")],
    split: OptionsText = "{}",
) -> None:
    """Gather the shards of a category into its catalogue, and split it.

    Example: `tetgan catalogue chairs.zip catalogue.csv`
    """
    from tetgan.shapes.catalogue import gather_catalogue
    from tetgan.shapes.options import SplitOptions

    gather_catalogue(shards, _options(SplitOptions, split, "--split"), out)


@app.command()
def clouds(
    out: Annotated[Path, typer.Argument(help="Point clouds (.npz) to write.")],
    category: Category,
    source: OptionsText,
    split: OptionsText = "{}",
    options: OptionsText = "{}",
    margin: Margin = 0.02,
) -> None:
    """Sample the raw surfaces of a source where they can be seen from outside.

    Example: `tetgan clouds chair.npz --category chair --source '{kind: builtin, count: 256}'`
    """
    from tetgan.config import CloudOptions
    from tetgan.shapes.clouds import sample_clouds
    from tetgan.shapes.options import SourceOptions, SplitOptions

    chosen = _options(CloudOptions, options, "--options")
    sample_clouds(
        category,
        _options(SourceOptions, source, "--source"),
        _options(SplitOptions, split, "--split"),
        points=chosen.points,
        train=chosen.train,
        holdout=chosen.holdout,
        margin=margin,
        seed=chosen.seed,
        out=out,
    )


@app.command()
def fields(
    meshes: Annotated[Path, typer.Argument(help="Zip written by `tetgan repair`.")],
    out: Annotated[Path, typer.Argument(help="Field store (.zarr.zip) to write.")],
    grid: OptionsText,
    threads: Threads = 1,
) -> None:
    """Sample occupancy and displacement of every mesh on a tetrahedral grid.

    Example: `tetgan fields chairs.zip chairs.zarr.zip --grid '{cells: 2, depth: 2}'`
    """
    os.environ["IGL_NUM_THREADS"] = str(threads)  # read when libigl loads; else every core
    from tetgan.fields.shards import extract_shard
    from tetgan.grids.options import GridOptions

    extract_shard(meshes, out, _options(GridOptions, grid, "--grid"))


@app.command()
def index(
    shards: Annotated[list[Path], typer.Argument(help="Field stores written by `tetgan fields`.")],
    out: Annotated[Path, typer.Argument(help="Index (.json) to write.")],
    catalogue: Annotated[Path, typer.Option(help="Catalogue that holds the split.")],
    grid: OptionsText,
) -> None:
    """Open several field stores as one data set.

    Example: `tetgan index chairs.zarr.zip index.json --catalogue catalogue.csv --grid '{cells: 2, depth: 2}'`
    """
    from tetgan.fields.store import index_fields
    from tetgan.grids.options import GridOptions

    index_fields(shards, catalogue, _options(GridOptions, grid, "--grid"), out)


@app.command()
def train(
    index: Annotated[Path, typer.Argument(help="Index written by `tetgan index`.")],
    folder: Annotated[Path, typer.Argument(help="Folder of the trained model; training resumes in it.")],
    model: OptionsText,
    training: OptionsText = "{}",
    seed: Seed = 0,
    threads: Threads = 2,
) -> None:
    """Train a model on the fields of one category; run again, it goes on where it was stopped.

    Example: `tetgan train index.json model --model '{kind: tetgan, grid: LR, width: 16, code: 32}'`
    """
    from tetgan.models.options import ModelOptions
    from tetgan.training.options import TrainingOptions
    from tetgan.training.trainer import train_model

    _use_threads(threads)
    train_model(
        index,
        _options(ModelOptions, model, "--model"),
        _options(TrainingOptions, training, "--training"),
        seed,
        folder,
    )


@app.command()
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

    _use_threads(threads)
    train_extractor(
        clouds, [cloud.stem for cloud in clouds], _options(ExtractorOptions, options, "--options"), folder
    )


@app.command()
def sample(
    model: Annotated[Path, typer.Argument(help="Folder of a trained model.")],
    index: Annotated[Path, typer.Argument(help="Index of the fields it was trained on.")],
    folder: Annotated[Path, typer.Argument(help="Folder of meshes to write.")],
    count: Annotated[int, typer.Option(min=1, help="Shapes to generate.")] = 16,
    mode: Annotated[str, typer.Option(help="How solids are built.")] = "paper",
    options: OptionsText = "{}",
    seed: Seed = 0,
) -> None:
    """Generate solid meshes, and reconstruct the validation shapes.

    Writes `none/` and `wls/` (without and with smoothing), each with `generated/` and `reconstructed/`
    surfaces (.ply) and solids (.vtu), and `certificate.csv` with the quality of every mesh.

    Example: `tetgan sample results/models/chair/tetgan-LR/0 results/fields/chair/LR/index.json chairs`
    """
    from tetgan.files import whole_folder
    from tetgan.meshing.options import MeshingOptions
    from tetgan.models.samples import write_samples

    chosen = MeshingOptions.parse(_plain(options, "--options") | {"mode": mode}, "sample")
    with whole_folder(folder) as partial:
        write_samples(model, index, partial, count=count, options=chosen, seed=seed)


@app.command()
def metrics(
    samples: Annotated[Path, typer.Argument(help="Folder written by `tetgan sample`.")],
    meshes: Annotated[list[Path], typer.Argument(help="Zips of repaired meshes, the reference.")],
    out: Annotated[Path, typer.Argument(help="Metrics (.json) to write.")],
    clouds: Annotated[Path, typer.Option(help="Point clouds with the hold-out surfaces.")],
    extractor: Annotated[Path, typer.Option(help="Folder of the trained classifier.")],
    identity: OptionsText = "{}",
    options: OptionsText = "{}",
    threads: Threads = 1,
) -> None:
    """Measure a model's samples: Chamfer, variety, FID, KID, faces, manifold edges, each with an interval.

    Example: `tetgan metrics samples chairs.zip metrics.json --clouds chair.npz --extractor extractor`
    """
    from tetgan.evaluation.evaluate import evaluate_model
    from tetgan.evaluation.options import EvaluationOptions

    _use_threads(threads)
    evaluate_model(
        samples,
        meshes=meshes,
        clouds=clouds,
        extractor=extractor,
        options=_options(EvaluationOptions, options, "--options"),
        identity=_plain(identity, "--identity"),
        out=out,
        threads=threads,
    )


@app.command()
def floor(
    meshes: Annotated[list[Path], typer.Argument(help="Zips of repaired meshes.")],
    out: Annotated[Path, typer.Argument(help="Metrics (.json) to write.")],
    category: Category,
    catalogue: Annotated[Path, typer.Option(help="Catalogue that holds the split.")],
    clouds: Annotated[Path, typer.Option(help="Point clouds of training and hold-out surfaces.")],
    extractor: Annotated[Path, typer.Option(help="Folder of the trained classifier.")],
    options: OptionsText = "{}",
    threads: Threads = 1,
) -> None:
    """Measure real shapes against real shapes: the floor under every metric.

    Example: `tetgan floor chairs.zip real.json --category chair --catalogue catalogue.csv --clouds chair.npz
    --extractor extractor`
    """
    from tetgan.evaluation.evaluate import evaluate_real
    from tetgan.evaluation.options import EvaluationOptions

    _use_threads(threads)
    evaluate_real(
        meshes,
        catalogue=catalogue,
        clouds=clouds,
        extractor=extractor,
        options=_options(EvaluationOptions, options, "--options"),
        category=category,
        out=out,
        threads=threads,
    )


@app.command()
def table(
    metrics: Annotated[list[Path], typer.Argument(help="Metrics of every model, seed and mode.")],
    out: Annotated[Path, typer.Argument(help="Table (.csv) to write; a .md twin stands beside it.")],
    category: Category,
    paper: Annotated[Path, typer.Option(help="The paper's published figures (.csv).")],
) -> None:
    """Set the metrics of a category beside the paper's figures.

    Example: `tetgan table results/metrics/chair/*/0/paper.json chair.csv --category chair --paper paper.csv`
    """
    from tetgan.evaluation.tables import write_table

    write_table(metrics, paper, category, out)


@app.command()
def report(
    results: Annotated[Path, typer.Argument(help="Folder of results, with tables/, figures/, samples/.")],
    out: Annotated[Path, typer.Argument(help="Page (.html) to write.")],
    config: OptionsText = "{}",
    captions: Annotated[Path | None, typer.Option(help="Folder of captions ({name}.rst).")] = None,
    model: Annotated[list[str] | None, typer.Option(help="Model whose solids to show; default: all.")] = None,
    samples: Annotated[int, typer.Option(min=1, help="Solids of each model.")] = 4,
) -> None:
    """Put every table and figure, solids to turn and cut open, and the provenance on one page.

    Example: `tetgan report results report.html --config config/config.yaml --captions workflow/report`
    """
    from tetgan.report.page import write_report

    write_report(
        results,
        out,
        config=_plain(config, "--config"),
        captions=captions,
        models=model or (),
        samples=samples,
    )
