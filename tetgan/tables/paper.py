"""The paper's published figures, and which of them belongs beside which row."""

from pathlib import Path

import pandas as pd

from tetgan.errors import UserError

_SMOOTHED = {"none": "No wLS", "wls": "wLS"}


# Supplement: "high-resolution models for benches and vases, and low-resolution models for sofas and tables".
_SUPPLEMENT_GRID = {"bench": "HR", "vase": "HR", "sofa": "LR", "table": "LR"}


# Models of the config that are ablations with a published FID; smoothing and grid are not told.
_ABLATIONS = {"no-local": "no patch discriminator", "no-global": "no global discriminator"}

_BASELINES = {
    "occnet": "OccNet",
    "occnet-simplified": "OccNet*",
    "shapegan-gan": "ShapeGAN (GAN)",
    "shapegan-gan-simplified": "ShapeGAN (GAN*)",
    "shapegan-vae": "ShapeGAN (VAE)",
    "shapegan-vae-simplified": "ShapeGAN (VAE*)",
}

_COLUMNS = ["table", "category", "model", "metric", "value"]


def read_paper(path: Path) -> pd.DataFrame:
    """The figures as printed (text), one a row: table, category, model, metric, value.

    Raises:
        UserError: no table, or one of other columns.
    """
    try:
        figures = pd.read_csv(path, dtype=str)
        if list(figures.columns) == _COLUMNS:
            return figures
    except ValueError:  # no table at all
        pass
    raise UserError(f"{path}: no table of the paper's figures; its columns are {', '.join(_COLUMNS)}")


def published(figures: pd.DataFrame, category: str, model: str, grid: str, smoothing: str) -> dict[str, str]:
    """Metric to printed figure, for a row that the paper has: TetGAN, a baseline, or one of two ablations.

    Its supplement does not say whether its one TetGAN row was smoothed, nor its text the ablations, so both
    of ours show those figures.
    """
    named = _BASELINES | _ABLATIONS
    names = [named[model]] if model in named else []
    if model == f"tetgan-{grid}":
        names = [f"TetGAN - {grid}/{_SMOOTHED[smoothing]}"]
        if _SUPPLEMENT_GRID.get(category) == grid:
            names.append("TetGAN")
    rows = figures[
        (figures["category"] == category) & figures["model"].isin(names) & (figures["value"] != "-")
    ]
    return dict(zip(rows["metric"], rows["value"], strict=True))


def quoted_figure(figures: pd.DataFrame, category: str, subject: str, metric: str) -> str | None:
    """What the paper's running text says of a subject, such as 'data set', as printed; None: nothing."""
    rows = figures[
        (figures["category"] == category) & (figures["model"] == subject) & (figures["metric"] == metric)
    ]
    return str(rows["value"].iloc[0]) if len(rows) else None
