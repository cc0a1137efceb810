"""Commands for metrics of samples, of real shapes, and of any two folders of meshes."""

from pathlib import Path
from typing import Annotated

import typer

from tetgan.cli.app import (
    Category,
    OptionsText,
    Threads,
    app,
    limit_libigl,
    read_options,
    read_plain,
    use_threads,
)

PANEL = "Evaluation"


@app.command(rich_help_panel=PANEL)
def evaluate_model(
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

    Example: `tetgan evaluate-model samples chairs.zip metrics.json --clouds chair.npz --extractor extractor`
    """
    limit_libigl(threads)
    from tetgan.evaluation.evaluate import evaluate_model
    from tetgan.evaluation.options import EvaluationOptions

    use_threads(threads)
    evaluate_model(
        samples,
        meshes=meshes,
        clouds=clouds,
        extractor=extractor,
        options=read_options(EvaluationOptions, options, "--options"),
        identity=read_plain(identity, "--identity"),
        out=out,
        catalogue=catalogue,
        threads=threads,
    )


@app.command(rich_help_panel=PANEL)
def evaluate_real(
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

    Example: `tetgan evaluate-real chairs.zip real.json --category chair --catalogue catalogue.csv
    --clouds chair.npz --extractor extractor`
    """
    limit_libigl(threads)
    from tetgan.evaluation.evaluate import evaluate_real
    from tetgan.evaluation.options import EvaluationOptions

    use_threads(threads)
    evaluate_real(
        meshes,
        catalogue=catalogue,
        clouds=clouds,
        extractor=extractor,
        options=read_options(EvaluationOptions, options, "--options"),
        category=category,
        out=out,
        threads=threads,
    )


@app.command(rich_help_panel=PANEL)
def evaluate(
    samples: Annotated[Path, typer.Argument(help="Folder of generated meshes, from any system.")],
    reference: Annotated[Path, typer.Argument(help="Folder of the real meshes they should be like.")],
    out: Annotated[Path, typer.Option(help="Report (.json) to write; with a .md twin.")],
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
    limit_libigl(threads)
    from tetgan.evaluation.options import EvaluationOptions
    from tetgan.tables.folders import evaluate_folders

    use_threads(threads)
    evaluate_folders(
        samples,
        reference,
        options=read_options(EvaluationOptions, options, "--options"),
        out=out,
        extractor=extractor,
        reconstructions=reconstructions,
        training=training,
        fit=normalise,
        threads=threads,
    )
