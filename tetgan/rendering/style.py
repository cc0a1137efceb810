"""How every plot looks: a white page as wide as a printed one, colours that everybody can tell apart."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pandas as pd
from matplotlib.figure import Figure

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
