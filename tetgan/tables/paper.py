"""The paper's published figures, matched to the rows of our tables."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.errors import UserError

OWN_METHODS = ("tetgan", "representation")
"""Methods of which the paper's running text speaks: its own, and the fields that it learns from."""

_SMOOTHED = {"none": "No wLS", "wls": "wLS"}


# Supplement: "high-resolution models for benches and vases, and low-resolution models for sofas and tables".
_SUPPLEMENT_GRID = {"bench": "HR", "vase": "HR", "sofa": "LR", "table": "LR"}


# The paper's name of a TetGAN without one of its critics: it gives their FID, but neither smoothing nor grid.
_WITHOUT = {"local": "no patch discriminator", "global": "no global discriminator"}

# Method, and whether its meshes are simplified, to the paper's name.
_BASELINES = {
    ("occnet", False): "OccNet",
    ("occnet", True): "OccNet*",
    ("shapegan-gan", False): "ShapeGAN (GAN)",
    ("shapegan-gan", True): "ShapeGAN (GAN*)",
    ("shapegan-vae", False): "ShapeGAN (VAE)",
    ("shapegan-vae", True): "ShapeGAN (VAE*)",
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


def published(
    figures: pd.DataFrame, category: str, report: Mapping[str, Any], smoothing: str
) -> dict[str, str]:
    """Metric to printed figure, for a row that the paper has: TetGAN, a baseline, or one of two ablations.

    The method of the report decides, not the model's name. The supplement does not say whether its one TetGAN
    row was smoothed, nor the text whether the ablations were, so both of ours show those figures.
    """
    names = _names_in_paper(category, report, smoothing)
    rows = figures[
        (figures["category"] == category) & figures["model"].isin(names) & (figures["value"] != "-")
    ]
    return dict(zip(rows["metric"], rows["value"], strict=True))


def _names_in_paper(category: str, report: Mapping[str, Any], smoothing: str) -> list[str]:
    method, grid, without = report.get("method", ""), report.get("grid"), report.get("without") or []
    baseline = _BASELINES.get((method, bool(report.get("simplified"))))
    if baseline:
        return [baseline]
    if method != "tetgan" or len(without) > 1:
        return []
    if without:
        return [_WITHOUT[without[0]]]
    in_supplement = ["TetGAN"] if _SUPPLEMENT_GRID.get(category) == grid else []
    return [f"TetGAN - {grid}/{_SMOOTHED[smoothing]}", *in_supplement]


def quoted_figure(figures: pd.DataFrame, category: str, subject: str, metric: str) -> str | None:
    """Figure in the paper's running text on a subject, such as 'data set', as printed, or None."""
    rows = figures[
        (figures["category"] == category) & (figures["model"] == subject) & (figures["metric"] == metric)
    ]
    return str(rows["value"].iloc[0]) if len(rows) else None
