"""Plots: their style, and training curves of several models."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from tetgan.files import check_suffix, whole_file

WIDTH = 7.2  # inches

COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5195", "#444444")
"""Okabe and Ito's, without the yellow that is too pale for lines."""

DASHES = ("-", "--", "-.", ":")

FIGURES = (".png", ".pdf", ".svg")
"""Formats of a plot."""

_STYLE: dict[Any, Any] = {
    "figure.dpi": 200,
    "figure.facecolor": "white",
    "font.size": 8,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.labelsize": 8,
    "axes.edgecolor": "#888888",
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.3,
    "lines.markersize": 3,
    "xtick.color": "#444444",
    "ytick.color": "#444444",
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
}


@contextmanager
def plot_style() -> Iterator[None]:
    """Plots made inside look alike; nothing outside changes."""
    with mpl.rc_context(_STYLE):
        yield


def line_styles(names: list[str]) -> dict[str, dict[str, Any]]:
    """Colour and dash of each name: colours first, then the next dash."""
    looks: list[dict[str, Any]] = [{"color": color, "linestyle": dash} for dash in DASHES for color in COLORS]
    return dict(zip(names, cycle(looks), strict=False))


def save_plot(path: str | Path, figure: Figure, data: pd.DataFrame) -> None:
    """Write a plot, and the numbers behind it as `.csv` beside it.

    Raises:
        UserError: the suffix is none of `FIGURES`.
    """
    path = Path(path)
    check_suffix(path, "a figure", *FIGURES)
    with whole_file(path) as partial:
        figure.savefig(partial, metadata=_undated(path))
    with whole_file(path.with_suffix(".csv")) as partial:
        data.to_csv(partial, index=False)


def _undated(path: Path) -> Mapping[str, str | None]:
    """No version of the library in the file, so that equal plots are equal bytes."""
    return {"Software": None} if path.suffix == ".png" else {}


_PANELS = {
    "validation_iou": "Validation IoU",
    "validation_occupancy_loss": "Occupancy loss, validation",
    "validation_displacement_loss": "Displacement loss, validation",
    "occupancy_loss": "Occupancy loss, training",
    "displacement_loss": "Displacement loss, training",
    "kl": "KL divergence, training",
    "reconstruction_loss": "Reconstruction loss, training",
    "local_gap": "Gap of the local critic",
    "global_gap": "Gap of the global critic",
    "gap": "Gap of the critic",
}

_NEVER = {
    *("model", "seed", "epoch", "seconds", "learning_rate", "kl_weight", "resolution", "fade"),
    *("local_penalty", "global_penalty", "penalty", "adversarial_loss", "adversarial_ratio"),
}

_WIDE = 3.0  # largest over smallest value of a loss from which its scale is logarithmic

_COLUMNS = 3

_HEIGHT = 1.75  # inches a row of panels

_LEGEND_LINE = 0.19  # inches


def draw_curves(logs: pd.DataFrame) -> Figure:
    """One panel per measure, against minutes of training; one line per model and seed.

    Args:
        logs: rows of every `log.csv`, with the columns `model` and `seed` in front. A measure that no model
            has gets no panel; a measure that is not known here is titled by its column.
    """
    names = list(dict.fromkeys(logs["model"]))
    measures = _measures(logs)
    rows = max(1, math.ceil(len(measures) / _COLUMNS))
    legend_columns = min(len(names), 4) or 1
    legend = _LEGEND_LINE * math.ceil(len(names) / legend_columns) + 0.1
    with plot_style():
        figure = Figure(figsize=(WIDTH, rows * _HEIGHT + legend), layout="constrained")
        for place, measure in enumerate(measures):
            axes = figure.add_subplot(rows, _COLUMNS, place + 1)
            _draw_measure(axes, logs, measure, names)
            if place + _COLUMNS >= len(measures):
                axes.set_xlabel("minutes of training")
        _draw_legend(figure, names, legend_columns)
    return figure


def _measures(logs: pd.DataFrame) -> list[str]:
    """Columns worth a panel: the known ones in their order, then the others."""
    numbers = [name for name in logs.columns if name not in _NEVER]
    shown = [name for name in numbers if pd.to_numeric(logs[name], errors="coerce").notna().any()]
    return [name for name in _PANELS if name in shown] + [name for name in shown if name not in _PANELS]


def _draw_measure(axes: Axes, logs: pd.DataFrame, measure: str, names: Sequence[str]) -> None:
    looks = line_styles(list(names))
    for (model, _), rows in logs.groupby(["model", "seed"], sort=False):
        run = rows[["seconds", measure]].dropna()
        if len(run):
            axes.plot(run["seconds"] / 60, run[measure], **looks[str(model)], marker=_marker(len(run)))
    axes.set_title(_PANELS.get(measure, measure.replace("_", " ").capitalize()))
    values = logs[measure].dropna().to_numpy(dtype=float)
    if "loss" in measure and len(values) and 0 < _WIDE * values.min() < values.max():
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_xlim(left=0)


def _marker(points: int) -> str | None:
    """Few points are marked: a line between two of them says little."""
    return "o" if points <= 12 else None


def _draw_legend(figure: Figure, names: Sequence[str], columns: int) -> None:
    looks = line_styles(list(names))
    handles = [Line2D([], [], label=name, **looks[name]) for name in names]
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=columns)
