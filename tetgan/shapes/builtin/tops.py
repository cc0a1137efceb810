"""Horizontal tops of tables and benches."""

from dataclasses import dataclass

import numpy as np

from tetgan.shapes.builtin.draws import between
from tetgan.shapes.builtin.parts import Part, box, outline, panel, sheet, slab, with_mirror


@dataclass(frozen=True)
class Top:
    """Sizes in metres; `height` is that of the upper side."""

    width: float
    depth: float
    height: float
    thick: float

    @property
    def under(self) -> float:
        return self.height - self.thick


def plank_top(top: Top) -> list[Part]:
    """One rectangular board with sharp edges."""
    return [box((top.width, top.thick, top.depth), (0, top.height - top.thick / 2, 0))]


def shaped_top(rng: np.random.Generator, top: Top, exponent: float | None) -> list[Part]:
    """A plate over a superellipse (None: a rectangle), its edges more or less bevelled."""
    plan = outline(top.width, top.depth, exponent=exponent, sides=40)
    return [slab(plan, top.under, top.height, edge=top.thick * between(rng, 0.0, 0.45))]


def boarded_top(top: Top, count: int) -> list[Part]:
    """Boards lengthwise with gaps between, on two bearers."""
    bearer = box((max(top.thick, 0.06), top.thick, top.depth * 0.96), (top.width * 0.41, top.under, 0))
    return [*long_boards(top, count), *with_mirror([bearer])]


def long_boards(top: Top, count: int) -> list[Part]:
    """Boards lengthwise, nothing under them."""
    pitch = top.depth / count
    size = (top.width, top.thick, pitch * 0.84)
    return [
        box(size, (0, top.height - top.thick / 2, -top.depth / 2 + (i + 0.5) * pitch)) for i in range(count)
    ]


def hollow_top(rng: np.random.Generator, top: Top) -> list[Part]:
    """A board hanging lower in the middle."""
    u = np.linspace(-1, 1, 15)[:, None]
    z = np.linspace(top.depth / 2, -top.depth / 2, 5)
    y = top.height - top.thick / 2 - between(rng, 0.02, 0.07) * (1 - u**2)
    grid = np.stack(np.broadcast_arrays(u * top.width / 2, y, z), axis=-1)
    return [panel(grid, top.thick)]


def glass_top(top: Top) -> list[Part]:
    """A pane without thickness in a frame, as many downloaded models have it."""
    x, z = np.meshgrid([-top.width / 2, top.width / 2], [top.depth / 2, -top.depth / 2], indexing="ij")
    pane = sheet(np.stack([x, np.full((2, 2), top.height - top.thick * 0.3), z], axis=-1))
    y, bar = top.height - top.thick / 2, top.thick
    side = box((bar, bar, top.depth), (top.width / 2 - bar / 2, y, 0))
    ends = [box((top.width, bar, bar), (0, y, s * (top.depth - bar) / 2)) for s in (1, -1)]
    return [pane, *with_mirror([side]), *ends]
