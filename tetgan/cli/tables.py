"""Commands that gather metrics into tables and write the report page."""

from pathlib import Path
from typing import Annotated

import typer

from tetgan.cli.app import Category, Metrics, OptionsText, Paper, TableOut, app, read_plain

PANEL = "Tables and report"


@app.command(rich_help_panel=PANEL)
def tabulate_category(
    metrics: Metrics,
    out: TableOut,
    category: Category,
    paper: Paper,
) -> None:
    """Set the metrics of a category beside the paper's figures.

    Example: `tetgan tabulate-category results/metrics/chair/*/0/paper.json chair.csv --category chair
    --paper paper.csv`
    """
    from tetgan.tables.category import tabulate_category

    tabulate_category(metrics, paper, category, out)


@app.command(rich_help_panel=PANEL)
def tabulate_supplement(
    metrics: Metrics,
    out: TableOut,
    figure: Annotated[str, typer.Option(help="fid, variety or reconstruction.")],
    paper: Paper,
) -> None:
    """Set one figure of every category side by side, as the paper's supplement does.

    Example: `tetgan tabulate-supplement results/metrics/*/*/*/paper.json fid.csv --figure fid
    --paper paper.csv`
    """
    from tetgan.tables.supplement import tabulate_supplement

    tabulate_supplement(metrics, paper, figure, out)


@app.command(rich_help_panel=PANEL)
def tabulate_manifold(metrics: Metrics, out: TableOut, paper: Paper) -> None:
    """Tell which share of edges is manifold, in ground truth and in generated shapes.

    Example: `tetgan tabulate-manifold results/metrics/*/*/*/paper.json manifold.csv --paper paper.csv`
    """
    from tetgan.tables.manifold import tabulate_manifold

    tabulate_manifold(metrics, paper, out)


@app.command(rich_help_panel=PANEL)
def tabulate_quality(
    samples: Annotated[
        list[Path], typer.Argument(help="Folders {category}/{model}/{seed}/{mode} of samples.")
    ],
    out: TableOut,
    paper: Paper,
    catalogue: Annotated[
        list[Path] | None,
        typer.Option(help="{category}/catalogue.csv, for the volumes of shapes. May be repeated."),
    ] = None,
) -> None:
    """Tell how many meshes are valid solids, what keeps the others from it, and whether they keep the shape.

    Example: `tetgan tabulate-quality results/samples/chair/tetgan-LR/0/* quality.csv --paper paper.csv
    --catalogue results/data/chair/catalogue.csv`
    """
    from tetgan.tables.quality import tabulate_quality

    tabulate_quality(samples, catalogue or [], paper, out)


@app.command(rich_help_panel=PANEL)
def tabulate_dataset(
    catalogues: Annotated[list[Path], typer.Argument(help="Catalogues: {category}/catalogue.csv.")],
    out: TableOut,
    paper: Paper,
) -> None:
    """Count the shapes of every category: listed, repaired, rejected and why, split, held out.

    Example: `tetgan tabulate-dataset results/data/*/catalogue.csv dataset.csv --paper paper.csv`
    """
    from tetgan.tables.dataset import tabulate_dataset

    tabulate_dataset(catalogues, paper, out)


@app.command(rich_help_panel=PANEL)
def tabulate_runtime(
    metrics: Metrics,
    out: TableOut,
    results: Annotated[Path, typer.Option(help="Folder with benchmarks/, data/ and clouds/.")],
    paper: Paper,
    shards: Annotated[int, typer.Option(min=1, help="Parts into which a category was cut.")] = 16,
) -> None:
    """Gather time and memory of every stage from Snakemake's benchmark files.

    Example: `tetgan tabulate-runtime results/metrics/*/*/*/paper.json runtime.csv --results results
    --paper paper.csv`
    """
    from tetgan.tables.runtime import tabulate_runtime

    tabulate_runtime(metrics, results, paper, shards, out)


@app.command(rich_help_panel=PANEL)
def tabulate_ablation(
    metrics: Metrics,
    out: TableOut,
    category: Category,
    paper: Paper,
    changes: Annotated[
        str, typer.Option(help="How each model differs, by name; JSON, or the path of a YAML or JSON file.")
    ] = "{}",
) -> None:
    """Set models that lack a part, or have another, beside the full one; rows keep the order of the files.

    Example: `tetgan tabulate-ablation full.json no-local.json ablation.csv --category chair
    --paper paper.csv`
    """
    from tetgan.tables.ablation import tabulate_ablation

    tabulate_ablation(metrics, paper, category, out, read_plain(changes, "--changes"))


@app.command(rich_help_panel=PANEL)
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
    from tetgan.report.page import report_page

    report_page(
        results,
        out,
        config=read_plain(config, "--config"),
        captions=captions,
        models=model or (),
        samples=samples,
    )
