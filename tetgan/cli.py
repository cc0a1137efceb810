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
Metrics = Annotated[list[Path], typer.Argument(help="Metrics (.json) of models and of real shapes.")]
TableOut = Annotated[Path, typer.Argument(help="Table (.csv) to write; a .md twin stands beside it.")]
Paper = Annotated[Path, typer.Option(help="The paper's published figures (.csv).")]
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


def _ids(text: str, count: int, name: str) -> Any:
    """Ids of shapes, joined by colons: an id has none."""
    ids = tuple(text.split(":"))
    if len(ids) != count or not all(ids):
        raise UserError(f"{name}: '{text}' is not {count} ids joined by colons")
    return ids


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
def samplings(
    meshes: Annotated[Path, typer.Argument(help="Zip written by `tetgan repair`.")],
    out: Annotated[Path, typer.Argument(help="Points or voxels (.zarr.zip) to write.")],
    sampling: OptionsText,
    threads: Threads = 1,
) -> None:
    """Sample every mesh at random points (occupancy) or on voxels (signed distance), for the baselines.

    Example: `tetgan samplings chairs.zip points.zarr.zip --sampling '{kind: points, count: 30000}'`
    """
    os.environ["IGL_NUM_THREADS"] = str(threads)  # read when libigl loads; else every core
    from tetgan.fields.options import ShapeSampling
    from tetgan.fields.samplings import sample_shard

    sample_shard(meshes, out, _options(ShapeSampling, sampling, "--sampling"))


@app.command()
def index(
    shards: Annotated[list[Path], typer.Argument(help="Written by `tetgan fields` or `tetgan samplings`.")],
    out: Annotated[Path, typer.Argument(help="Index (.json) to write.")],
    catalogue: Annotated[Path, typer.Option(help="Catalogue that holds the split.")],
    grid: OptionsText = "",
    sampling: OptionsText = "",
) -> None:
    """Open several shards as one data set: of fields (--grid) or of points or voxels (--sampling).

    Example: `tetgan index chairs.zarr.zip index.json --catalogue catalogue.csv --grid '{cells: 2, depth: 2}'`
    """
    from tetgan.fields.options import ShapeSampling
    from tetgan.fields.samplings import index_samplings
    from tetgan.fields.store import index_fields
    from tetgan.grids.options import GridOptions

    if bool(grid) == bool(sampling):
        raise UserError("index: give --grid for fields, or --sampling for points and voxels")
    if grid:
        index_fields(shards, catalogue, _options(GridOptions, grid, "--grid"), out)
    else:
        index_samplings(shards, catalogue, _options(ShapeSampling, sampling, "--sampling"), out)


@app.command()
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

    _use_threads(threads)
    chosen = _options(ModelOptions, model, "--model")
    options = _options(training_class(chosen), training, "--training")
    train_model(index, chosen, options, seed, folder, of=of)


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
    index: Annotated[Path, typer.Argument(help="Index of the fields, points or voxels it was trained on.")],
    folder: Annotated[Path, typer.Argument(help="Folder of meshes to write.")],
    count: Annotated[int, typer.Option(min=1, help="Shapes to generate.")] = 16,
    mode: Annotated[str, typer.Option(help="How solids are built: 'solid' or 'paper'.")] = "solid",
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

    chosen = MeshingOptions.parse(_plain(options, "--options") | {"mode": mode}, "sample")
    _use_threads(threads)
    with whole_folder(folder) as partial:
        write_samples(model, index, partial, count=count, options=chosen, seed=seed)


@app.command()
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


@app.command()
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
    from tetgan.studies.figure_options import LatentOptions
    from tetgan.studies.interpolation import write_interpolations

    chosen = _options(LatentOptions, options, "--options")
    shape = _options(MeshingOptions, meshing, "--meshing")
    pairs = [_ids(text, 2, "--pair") for text in pair or []]
    with whole_folder(folder) as partial:
        write_interpolations(model, index, partial, options=chosen, meshing=shape, pairs=pairs)


@app.command()
def arithmetic(
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

    Example: `tetgan arithmetic results/models/chair/tetgan-LR/0 results/fields/chair/LR/index.json sums
    --triple chair-0003:chair-0017:chair-0021`
    """
    from tetgan.files import whole_folder
    from tetgan.meshing.options import MeshingOptions
    from tetgan.studies.arithmetic import write_arithmetic
    from tetgan.studies.figure_options import LatentOptions

    chosen = _options(LatentOptions, options, "--options")
    shape = _options(MeshingOptions, meshing, "--meshing")
    triples = [_ids(text, 3, "--triple") for text in triple or []]
    with whole_folder(folder) as partial:
        write_arithmetic(model, index, partial, options=chosen, meshing=shape, triples=triples)


@app.command()
def nearest(
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

    Example: `tetgan nearest chairs.zip nearest.csv --catalogue catalogue.csv --samples samples`
    """
    from tetgan.studies.figure_options import NearestOptions
    from tetgan.studies.nearest import write_nearest

    chosen = _options(NearestOptions, options, "--options")
    write_nearest(meshes, catalogue, out, samples=samples, options=chosen, threads=threads)


@app.command()
def metrics(
    samples: Annotated[Path, typer.Argument(help="Folder written by `tetgan sample`.")],
    meshes: Annotated[list[Path], typer.Argument(help="Zips of repaired meshes, the reference.")],
    out: Annotated[Path, typer.Argument(help="Metrics (.json) to write.")],
    clouds: Annotated[Path, typer.Option(help="Point clouds with the hold-out surfaces.")],
    extractor: Annotated[Path, typer.Option(help="Folder of the trained classifier.")],
    catalogue: Annotated[
        Path | None, typer.Option(help="Catalogue that tells the training shapes, for novelty.")
    ] = None,
    identity: OptionsText = "{}",
    options: OptionsText = "{}",
    threads: Threads = 1,
) -> None:
    """Measure a model's samples: Chamfer, variety, FID, coverage, overlap and more, each with an interval.

    Example: `tetgan metrics samples chairs.zip metrics.json --clouds chair.npz --extractor extractor`
    """
    os.environ["IGL_NUM_THREADS"] = str(threads)  # read when libigl loads; else every core
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
        catalogue=catalogue,
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
    os.environ["IGL_NUM_THREADS"] = str(threads)  # read when libigl loads; else every core
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
def evaluate(
    samples: Annotated[Path, typer.Argument(help="Folder of generated meshes, from any system.")],
    reference: Annotated[Path, typer.Argument(help="Folder of the real meshes they should be like.")],
    out: Annotated[Path, typer.Option(help="Report (.json) to write; a .md twin stands beside it.")],
    extractor: Annotated[
        Path | None, typer.Option(help="Folder of a trained classifier, for FID and its kin.")
    ] = None,
    reconstructions: Annotated[
        Path | None, typer.Option(help="Folder of meshes named as those of REFERENCE that they should be.")
    ] = None,
    training: Annotated[
        Path | None, typer.Option(help="Folder of what the generator learned from, for novelty.")
    ] = None,
    normalise: Annotated[bool, typer.Option(help="Fit every mesh to the unit cube first.")] = False,
    options: OptionsText = "{}",
    threads: Threads = 1,
) -> None:
    """Measure any two folders of meshes (.obj .off .ply .stl .glb) against each other, with floors.

    Example: `tetgan evaluate my/samples my/chairs --out report.json --extractor results/extractor`
    """
    os.environ["IGL_NUM_THREADS"] = str(threads)  # read when libigl loads; else every core
    from tetgan.evaluation.folders import evaluate_folders
    from tetgan.evaluation.options import EvaluationOptions

    _use_threads(threads)
    evaluate_folders(
        samples,
        reference,
        options=_options(EvaluationOptions, options, "--options"),
        out=out,
        extractor=extractor,
        reconstructions=reconstructions,
        training=training,
        fit=normalise,
        threads=threads,
    )


@app.command()
def table(
    metrics: Metrics,
    out: TableOut,
    category: Category,
    paper: Paper,
) -> None:
    """Set the metrics of a category beside the paper's figures.

    Example: `tetgan table results/metrics/chair/*/0/paper.json chair.csv --category chair --paper paper.csv`
    """
    from tetgan.evaluation.tables import write_table

    write_table(metrics, paper, category, out)


@app.command()
def supplement(
    metrics: Metrics,
    out: TableOut,
    figure: Annotated[str, typer.Option(help="fid, variety or reconstruction.")],
    paper: Paper,
) -> None:
    """Set one figure of benches, sofas, tables and vases side by side, as the paper's supplement does.

    Example: `tetgan supplement results/metrics/*/*/*/paper.json fid.csv --figure fid --paper paper.csv`
    """
    from tetgan.evaluation.gathered.supplement import write_supplement

    write_supplement(metrics, paper, figure, out)


@app.command()
def manifold(metrics: Metrics, out: TableOut, paper: Paper) -> None:
    """Tell which share of edges is manifold, in ground truth and in generated shapes.

    Example: `tetgan manifold results/metrics/*/*/*/paper.json manifold.csv --paper paper.csv`
    """
    from tetgan.evaluation.gathered.manifold import write_manifold

    write_manifold(metrics, paper, out)


@app.command()
def dataset(
    catalogues: Annotated[list[Path], typer.Argument(help="Catalogues: {category}/catalogue.csv.")],
    out: TableOut,
    paper: Paper,
) -> None:
    """Count the shapes of every category: listed, repaired, rejected and why, split, held out.

    Example: `tetgan dataset results/data/*/catalogue.csv dataset.csv --paper paper.csv`
    """
    from tetgan.evaluation.gathered.dataset import write_dataset

    write_dataset(catalogues, paper, out)


@app.command()
def runtime(
    metrics: Metrics,
    out: TableOut,
    results: Annotated[Path, typer.Option(help="Folder with benchmarks/, data/ and clouds/.")],
    paper: Paper,
    shards: Annotated[int, typer.Option(min=1, help="Parts into which a category was cut.")] = 16,
) -> None:
    """Gather time and memory of every stage from Snakemake's benchmark files.

    Example: `tetgan runtime results/metrics/*/*/*/paper.json runtime.csv --results results --paper paper.csv`
    """
    from tetgan.evaluation.gathered.runtime import write_runtime

    write_runtime(metrics, results, paper, shards, out)


@app.command()
def ablation(
    metrics: Metrics,
    out: TableOut,
    category: Category,
    paper: Paper,
    changes: Annotated[
        str, typer.Option(help="How each model differs, by name; JSON, or the path of a YAML or JSON file.")
    ] = "{}",
) -> None:
    """Set models that lack a part, or have another, beside the full one; rows keep the order of the files.

    Example: `tetgan ablation full.json no-local.json ablation.csv --category chair --paper paper.csv`
    """
    from tetgan.evaluation.ablation import write_ablation

    write_ablation(metrics, paper, category, out, _plain(changes, "--changes"))


@app.command()
def resolution(
    table: Annotated[Path, typer.Argument(help="Table (.csv) to write; a .md twin stands beside it.")],
    figure: Annotated[Path, typer.Argument(help="Figure (.png) to write; its data stand beside it.")],
    options: OptionsText = "{}",
    threads: Threads = 1,
) -> None:
    """Measure how fine tets and voxels must be to represent a torus equally well.

    Example: `tetgan resolution resolution.csv resolution.png`
    """
    os.environ["IGL_NUM_THREADS"] = str(threads)  # read when libigl loads; else every core
    from tetgan.studies.options import ResolutionOptions
    from tetgan.studies.resolution import study_resolution

    study_resolution(_options(ResolutionOptions, options, "--options"), table, figure)


@app.command()
def smoothing(
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

    Example: `tetgan smoothing models/chair/representation-LR/0 index.json study chairs.zip --clouds chair.npz
    --extractor extractor`
    """
    os.environ["IGL_NUM_THREADS"] = str(threads)  # read when libigl loads; else every core
    from tetgan.evaluation.options import EvaluationOptions
    from tetgan.meshing.options import MeshingOptions
    from tetgan.studies.options import SmoothingOptions
    from tetgan.studies.smoothing import study_smoothing

    _use_threads(threads)
    study_smoothing(
        model,
        index,
        folder,
        meshes=meshes,
        clouds=clouds,
        extractor=extractor,
        study=_options(SmoothingOptions, options, "--options"),
        meshing=_options(MeshingOptions, meshing, "--meshing"),
        evaluation=_options(EvaluationOptions, evaluation, "--evaluation"),
        identity=_plain(identity, "--identity"),
    )


@app.command("smoothing-table")
def smoothing_table(
    studies: Annotated[list[Path], typer.Argument(help="Folders written by `tetgan smoothing`.")],
    out: Annotated[Path, typer.Argument(help="Table (.csv) to write; a .md twin stands beside it.")],
) -> None:
    """Set the smoothing studies side by side, and weigh the paper's claims.

    Example: `tetgan smoothing-table studies/chair/* smoothing.csv`
    """
    from tetgan.studies.smoothing_table import write_smoothing_table

    write_smoothing_table(studies, out)


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
