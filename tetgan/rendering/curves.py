"""Training curves of several models."""

import math
from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from tetgan.rendering.style import WIDTH, line_styles, plot_style

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
    *("local_penalty", "global_penalty", "penalty", "adversarial_loss"),
}
_WIDE = 3.0  # largest over smallest value of a loss from which its scale is logarithmic
_COLUMNS = 3
_HEIGHT = 1.75  # inches a row of panels
_LEGEND_LINE = 0.19  # inches


def draw_curves(logs: pd.DataFrame) -> Figure:
    """A panel a measure, against minutes of training; one line a model and seed.

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
