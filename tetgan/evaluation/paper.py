"""The paper's published figures, and which of them belongs beside which row."""

from pathlib import Path

import pandas as pd

from tetgan.errors import UserError

_SMOOTHED = {"none": "No wLS", "wls": "wLS"}
# Supplement: "high-resolution models for benches and vases, and low-resolution models for sofas and tables".
_SUPPLEMENT_GRID = {"bench": "HR", "vase": "HR", "sofa": "LR", "table": "LR"}
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
        UserError: other columns.
    """
    figures = pd.read_csv(path, dtype=str)
    if list(figures.columns) != _COLUMNS:
        raise UserError(f"{path}: expected the columns {', '.join(_COLUMNS)}")
    return figures


def published(figures: pd.DataFrame, category: str, model: str, grid: str, smoothing: str) -> dict[str, str]:
    """Metric to printed figure, for a row that the paper has: `tetgan-LR`, `tetgan-HR` or a baseline.

    Its supplement does not say whether its one TetGAN row was smoothed, so both of ours show it.
    """
    names = [_BASELINES[model]] if model in _BASELINES else []
    if model == f"tetgan-{grid}":
        names = [f"TetGAN - {grid}/{_SMOOTHED[smoothing]}"]
        if _SUPPLEMENT_GRID.get(category) == grid:
            names.append("TetGAN")
    rows = figures[
        (figures["category"] == category) & figures["model"].isin(names) & (figures["value"] != "-")
    ]
    return dict(zip(rows["metric"], rows["value"], strict=True))
