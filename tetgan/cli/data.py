"""Commands from raw meshes to training data."""

from pathlib import Path
from typing import Annotated

import typer

from tetgan.cli.app import Category, Margin, OptionsText, Threads, app, limit_libigl, read_options
from tetgan.errors import UserError

PANEL = "Data"


@app.command(rich_help_panel=PANEL)
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
        read_options(SourceOptions, source, "--source"),
        read_options(RepairOptions, options, "--options"),
        margin=margin,
        shard=shard,
        out=out,
    )


@app.command(rich_help_panel=PANEL)
def gather_catalogue(
    shards: Annotated[list[Path], typer.Argument(help="Zips written by `tetgan repair`.")],
    out: Annotated[Path, typer.Argument(help="Catalogue (.csv) to write.")],
    split: OptionsText = "{}",
) -> None:
    """Gather the shards of a category into its catalogue, and split it.

    Example: `tetgan gather-catalogue chairs.zip catalogue.csv`
    """
    from tetgan.shapes.catalogue import gather_catalogue
    from tetgan.shapes.options import SplitOptions

    gather_catalogue(shards, read_options(SplitOptions, split, "--split"), out)


@app.command(rich_help_panel=PANEL)
def sample_clouds(
    out: Annotated[Path, typer.Argument(help="Point clouds (.npz) to write.")],
    category: Category,
    source: OptionsText,
    split: OptionsText = "{}",
    options: OptionsText = "{}",
    margin: Margin = 0.02,
) -> None:
    """Sample the raw surfaces of a source where they can be seen from outside.

    Example: `tetgan sample-clouds chair.npz --category chair --source '{kind: builtin, count: 256}'`
    """
    from tetgan.config import CloudOptions
    from tetgan.shapes.cloud_sampling import sample_clouds
    from tetgan.shapes.options import SourceOptions, SplitOptions

    chosen = read_options(CloudOptions, options, "--options")
    sample_clouds(
        category,
        read_options(SourceOptions, source, "--source"),
        read_options(SplitOptions, split, "--split"),
        points=chosen.points,
        train=chosen.train,
        holdout=chosen.holdout,
        margin=margin,
        seed=chosen.seed,
        out=out,
    )


@app.command(rich_help_panel=PANEL)
def extract_fields(
    meshes: Annotated[Path, typer.Argument(help="Zip written by `tetgan repair`.")],
    out: Annotated[Path, typer.Argument(help="Field store (.zarr.zip) to write.")],
    grid: OptionsText,
    threads: Threads = 1,
) -> None:
    """Sample occupancy and displacement of every mesh on a tetrahedral grid.

    Example: `tetgan extract-fields chairs.zip chairs.zarr.zip --grid '{cells: 2, depth: 2}'`
    """
    limit_libigl(threads)
    from tetgan.fields.extraction import extract_shard
    from tetgan.grids.options import GridOptions

    extract_shard(meshes, out, read_options(GridOptions, grid, "--grid"))


@app.command(rich_help_panel=PANEL)
def extract_samplings(
    meshes: Annotated[Path, typer.Argument(help="Zip written by `tetgan repair`.")],
    out: Annotated[Path, typer.Argument(help="Points or voxels (.zarr.zip) to write.")],
    sampling: OptionsText,
    threads: Threads = 1,
) -> None:
    """Sample every mesh at random points (occupancy) or on voxels (signed distance), for the baselines.

    Example: `tetgan extract-samplings chairs.zip points.zarr.zip --sampling '{kind: points, count: 30000}'`
    """
    limit_libigl(threads)
    from tetgan.fields.options import ShapeSampling
    from tetgan.fields.samplings import extract_samplings

    extract_samplings(meshes, out, read_options(ShapeSampling, sampling, "--sampling"))


@app.command(rich_help_panel=PANEL)
def index(
    shards: Annotated[
        list[Path], typer.Argument(help="Written by `tetgan extract-fields` or `tetgan extract-samplings`.")
    ],
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
        index_fields(shards, catalogue, read_options(GridOptions, grid, "--grid"), out)
    else:
        index_samplings(shards, catalogue, read_options(ShapeSampling, sampling, "--sampling"), out)
