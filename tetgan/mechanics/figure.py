"""A body at rest beside the same body under its loads: displacement exaggerated, stress in colour."""

import math
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from jaxtyping import Float, UInt8
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from tetgan.geometry.adjacency import boundary_faces
from tetgan.mechanics.simulation import Push, Simulation
from tetgan.rendering.plots import WIDTH, plot_style, save_plot
from tetgan.rendering.view import View

WOOD: tuple[float, float, float] = (0.60, 0.36, 0.16)  # linear RGB of the body at rest

_COLOURS = "turbo"

_SHOWN = 0.12  # of the body's longest side: how far the exaggerated displacement may go

_VIEW = View(size=(900, 900), azimuth=35, elevation=18)

_ARROWS = 5  # most arrows of a load along either direction across it

_ARROW = 0.11  # length of an arrow, cube sides

Units = tuple[tuple[float, str], ...]

_LENGTHS: Units = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"))

_STRESSES: Units = ((1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa"))

_GAMMA = 2.2  # from a screen's colours to linear light, as the ray caster goes back


def draw_simulation(result: Simulation, title: str) -> Figure:
    """Two pictures and a colour bar.

    Args:
        result: of a body in the unit cube.
        title: what it is.
    """
    times = exaggeration(result)
    moved = result.vertices + times * result.displacement / result.size
    view = _view(result, moved)
    faces = boundary_faces(result.tets)
    stress = result.vertex_stress[faces].mean(axis=1)
    top = float(np.percentile(stress, 99.5)) or 1.0
    shades = mpl.colormaps[_COLOURS](np.clip(stress / top, 0, 1))
    rest = view.draw(result.vertices, faces, WOOD)
    bent = view.draw(moved, faces, shades[:, :3] ** _GAMMA)
    peak = float(np.linalg.norm(result.displacement, axis=1).max())
    with plot_style():
        figure = Figure(figsize=(WIDTH, 0.5 * WIDTH), layout="constrained")
        left, right = figure.subplots(1, 2)
        _show(left, rest, f"{title}\nat rest, its load {_loads(result)}")
        for push in result.pushes:
            _draw_arrows(left, push, view)
        _show(right, bent, f"moves {_handy(peak, _LENGTHS)} at most,\nshown {times:,g} times larger")
        right.contour((rest < 255).any(axis=2), levels=[0.5], colors="#666666", linewidths=0.6)
        unit, name = _unit_of(top, _STRESSES)
        colours = ScalarMappable(Normalize(0, top / unit), _COLOURS)
        bar = figure.colorbar(colours, ax=[left, right], shrink=0.7, extend="max")
        bar.set_label(f"von Mises stress, {name}")
    return figure


def write_figure(path: Path, result: Simulation, title: str) -> None:
    """Write the picture, and the figures behind it as `.csv` beside it."""
    data = pd.DataFrame([{**result.record(), "exaggeration": exaggeration(result)}])
    save_plot(path, draw_simulation(result, title), data)


def exaggeration(result: Simulation) -> float:
    """The largest of 1, 2, 5, 10, … by which the displacement is drawn and still stays moderate.

    A displacement that is large as it is comes out as 1.
    """
    peak = float(np.linalg.norm(result.displacement, axis=1).max()) / result.size
    most = _SHOWN * float(np.ptp(result.vertices, axis=0).max()) / max(peak, 1e-30)
    power = 10.0 ** math.floor(math.log10(max(most, 1.0)))
    return max(step * power for step in (1, 2, 5) if step * power <= max(most, 1.0))


def _view(result: Simulation, moved: Float[np.ndarray, "V 3"]) -> View:
    """A view with both bodies and the arrows in it."""
    raised = [push.places - _ARROW * 1.1 * _unit(push.force) for push in result.pushes]
    return _VIEW.close_to([result.vertices, moved, *raised])


def _unit_of(value: float, units: Units) -> tuple[float, str]:
    """The largest unit of which there is at least one."""
    return next((unit for unit in units if value >= unit[0]), units[-1])


def _handy(value: float, units: Units) -> str:
    unit, name = _unit_of(value, units)
    return f"{value / unit:.3g} {name}"


def _loads(result: Simulation) -> str:
    forces = [float(np.linalg.norm(push.force)) for push in result.pushes]
    return " and ".join(f"{force:g} N" for force in forces) or "its own weight"


def _show(axes: Axes, picture: UInt8[np.ndarray, "H W 3"], title: str) -> None:
    axes.imshow(picture)
    axes.set_title(title, loc="center")
    axes.set_axis_off()


def _draw_arrows(axes: Axes, push: Push, view: View) -> None:
    """Arrows that end on a load's faces, spread over them."""
    ends = _spread(push.places, int(np.abs(push.force).argmax()))
    starts = ends - _ARROW * _unit(push.force)
    for start, end in zip(view.pixels(starts), view.pixels(ends), strict=True):
        looks = {"arrowstyle": "-|>", "color": "#B00020", "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", xy=tuple(end), xytext=tuple(start), arrowprops=looks)


def _spread(places: Float[np.ndarray, "P 3"], axis: int) -> Float[np.ndarray, "A 3"]:
    """The place nearest to the middle of each cell of a coarse net over them, seen along an axis."""
    low, extent = places.min(axis=0), np.ptp(places, axis=0)
    inside = (places - low) / np.where(extent > 0, extent, 1.0) * _ARROWS
    inside[:, axis] = 0.5
    cells = np.minimum(inside.astype(np.int64), _ARROWS - 1)
    order = np.argsort(((inside - cells - 0.5) ** 2).sum(axis=1), kind="stable")
    _, first = np.unique(cells[order], axis=0, return_index=True)
    return places[order[first]]


def _unit(force: tuple[float, float, float]) -> Float[np.ndarray, "3"]:
    return np.array(force) / (np.linalg.norm(force) or 1.0)
