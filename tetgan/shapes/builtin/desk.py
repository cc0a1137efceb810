"""Writing desks: a top on chests of drawers, legs and panels."""

from dataclasses import dataclass

import numpy as np

from tetgan.shapes.builtin import supports, tops
from tetgan.shapes.builtin.draws import between, chance, pick
from tetgan.shapes.builtin.parts import Part, bar, box, with_mirror
from tetgan.shapes.builtin.supports import Footprint
from tetgan.shapes.builtin.tops import Top


@dataclass(frozen=True)
class Chest:
    """A block of drawers, metres: middle in x, extents, and heights of its lower and upper side."""

    x: float
    width: float
    depth: float
    low: float
    high: float


def make_desk(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Drawers on one or both sides, legs or a panel on the other."""
    top = Top(
        between(rng, 1.1, 1.7), between(rng, 0.55, 0.8), between(rng, 0.72, 0.78), between(rng, 0.04, 0.08)
    )
    block, feet = between(rng, 0.32, 0.46), between(rng, 0.0, 0.15)
    room = top.under - feet
    low = top.under - room * (between(rng, 0.45, 1.0) if chance(rng, 0.4) else 1.0)
    drawers = _drawers(rng, Chest(top.width / 2 - block / 2 - 0.02, block, top.depth * 0.94, low, top.under))
    sides = pick(rng, {"both": 1, "one": 2})
    parts = [*tops.plank_top(top), *(with_mirror(drawers) if sides == "both" else drawers)]
    foot = Footprint(top.width - 0.04, top.depth * 0.94, top.under, between(rng, 0.06, 0.1))
    stand = "legs" if low > 0.06 else pick(rng, {"legs": 2, "panel": 1})
    if low > 0.06:
        parts += supports.plain_legs(rng, foot)
    elif sides == "one":
        parts += _open_side(foot, stand)
    if chance(rng, 0.5):
        modesty = (top.width * 0.9, top.under * between(rng, 0.3, 0.6), 0.04)
        parts.append(box(modesty, (0, top.under * 0.7, -top.depth * 0.44)))
    parts += _hutch(rng, top) if chance(rng, 0.2) else []
    return parts, f"desk-{sides}/{stand}"


def knob(x: float, y: float, z: float) -> Part:
    """Round handle standing out of a front at depth z."""
    return bar((x, y, z - 0.005), (x, y, z + 0.03), 0.045, taper=0.8)


def _drawers(rng: np.random.Generator, chest: Chest) -> list[Part]:
    """The chest, and fronts standing out a little, each with a knob or a handle."""
    tall, front = chest.high - chest.low, chest.depth / 2
    count = max(1, round(tall / between(rng, 0.15, 0.26)))
    parts = [box((chest.width, tall + 0.01, chest.depth), (chest.x, (chest.high + chest.low) / 2, 0))]
    knobs = chance(rng, 0.5)
    for y in chest.low + (np.arange(count) + 0.5) * tall / count:
        parts.append(box((chest.width * 0.9, tall / count * 0.86, 0.02), (chest.x, y, front + 0.008)))
        handle = box((chest.width * 0.35, 0.025, 0.03), (chest.x, y, front + 0.028))
        parts.append(knob(chest.x, y, front + 0.015) if knobs else handle)
    return parts


def _open_side(foot: Footprint, kind: str) -> list[Part]:
    """What carries the end without drawers, at -x."""
    leg, tall = foot.thickness, foot.height + 0.01
    if kind == "panel":
        return [box((leg * 0.7, tall, foot.depth), (-foot.width / 2 + leg * 0.35, tall / 2, 0))]
    x, z = foot.corners()[0]
    return [box((leg, tall, leg), (-x, tall / 2, side * z)) for side in (1, -1)]


def _hutch(rng: np.random.Generator, top: Top) -> list[Part]:
    """Shelves standing at the rear of the top."""
    tall, deep, board = between(rng, 0.25, 0.5), top.depth * between(rng, 0.3, 0.4), 0.045
    z = -top.depth / 2 + deep / 2
    side = box((board, tall + 0.01, deep), (top.width / 2 - board, top.height + tall / 2, z))
    levels = [tall] if tall < 0.35 else [tall / 2, tall]
    shelf = (top.width - board, board, deep)
    return [*with_mirror([side]), *(box(shelf, (0, top.height + y - board / 2, z)) for y in levels)]
