"""Tables: oblong, centred, one-thickness, shelved and picnic tables, and desks."""

from dataclasses import dataclass

import numpy as np

from tetgan.shapes.builtin import supports, tops
from tetgan.shapes.builtin.draws import between, chance, pick, pick_from, whole
from tetgan.shapes.builtin.parts import Part, bar, box, ellipse, lathe, outline, slab, with_mirror
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


SUPPORTS: dict[str, tuple[supports.Support, float]] = {
    "legs": (supports.straight_legs, 6),
    "splayed": (supports.splayed_legs, 3),
    "turned": (supports.turned_legs, 2.5),
    "curved": (supports.curved_legs, 2),
    "hairpin": (supports.hairpin_legs, 1),
    "sled": (supports.sled_runners, 1.5),
    "panels": (supports.side_panels, 1.5),
    "trestles": (supports.trestles, 2.5),
    "crossed": (supports.crossed_legs, 1.5),
    "plinth": (supports.plinth, 0.5),
}


def make_table(rng: np.random.Generator) -> tuple[list[Part], str]:
    """One table and its structural kind."""
    return pick(rng, {_oblong: 42, _centred: 24, make_desk: 15, _one_thickness: 7, _shelved: 7, _picnic: 5})(
        rng
    )


# --- oblong -------------------------------------------------------------------------------------------------


def _oblong(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A top on legs at its corners or ends."""
    use = pick(rng, {"dining": 4, "coffee": 3, "side": 2, "console": 1.5})
    top = _oblong_top(rng, use)
    shape = pick(rng, {"rectangle": 4, "rounded": 2, "oval": 1.5, "boards": 1, "glass": 0.7})
    stand, make_stand = pick_from(rng, SUPPORTS)
    inset = _inset(rng, shape, stand)
    leg = max(top.width, top.height) * between(rng, 0.042, 0.075)
    foot = Footprint(top.width * inset, top.depth * min(inset, 0.94), top.under, leg)
    parts = [*_top(rng, shape, top), *make_stand(rng, foot)]
    if stand in ("legs", "turned", "splayed") and use != "dining" and chance(rng, 0.4):
        shelf = (foot.width * 0.98, top.thick * 0.7, foot.depth * 0.95)
        parts.append(box(shelf, (0, top.height * between(rng, 0.2, 0.4), 0)))
        stand += "-shelf"
    if stand in ("legs", "turned") and chance(rng, 0.3):
        parts += _drawer_row(rng, foot)
        stand += "-drawers"
    return parts, f"{use}-{shape}/{stand}"


def _inset(rng: np.random.Generator, shape: str, stand: str) -> float:
    """Extent of the legs over that of the top: what fits a rectangle would stand beside an oval."""
    if shape == "oval":
        return 0.7
    if shape == "rounded" or stand == "trestles":
        return between(rng, 0.74, 0.84)
    return between(rng, 0.86, 1.0)


def _oblong_top(rng: np.random.Generator, use: str) -> Top:
    width, depth, height = {
        "dining": (between(rng, 1.1, 2.0), between(rng, 0.75, 1.0), between(rng, 0.70, 0.78)),
        "coffee": (between(rng, 0.85, 1.35), between(rng, 0.5, 0.8), between(rng, 0.36, 0.5)),
        "side": (between(rng, 0.45, 0.65), between(rng, 0.42, 0.62), between(rng, 0.5, 0.7)),
        "console": (between(rng, 1.0, 1.4), between(rng, 0.32, 0.42), between(rng, 0.75, 0.88)),
    }[use]
    return Top(width, depth, height, max(width, height) * between(rng, 0.03, 0.07))


def _top(rng: np.random.Generator, shape: str, top: Top) -> list[Part]:
    if shape == "boards":
        return tops.boarded_top(top, whole(rng, 4, 6))
    if shape == "glass":
        return tops.glass_top(top)
    if shape == "octagon":
        plan = outline(top.width, top.depth, exponent=2.0, sides=8)
        return [slab(plan, top.under, top.height, edge=top.thick * between(rng, 0.0, 0.45))]
    exponents = {"rectangle": None, "square": None, "oval": 2.0, "round": 2.0}
    return tops.shaped_top(rng, top, exponents.get(shape, between(rng, 4.0, 9.0)))


def _drawer_row(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """A shallow box under the top with fronts and knobs."""
    tall, count = foot.height * between(rng, 0.14, 0.22), whole(rng, 1, 3)
    y, front = foot.height - tall / 2, foot.depth / 2 - foot.thickness * 0.3
    pitch = (foot.width - 2 * foot.thickness) / count
    parts = [box((foot.width - foot.thickness, tall, 2 * front), (0, y, 0))]
    for x in (np.arange(count) + 0.5 - count / 2) * pitch:
        parts += [box((pitch * 0.92, tall * 0.78, 0.02), (x, y, front + 0.01)), knob(x, y, front + 0.02)]
    return parts


# --- centred ------------------------------------------------------------------------------------------------

# Ranges of the height and of the width of the top, metres.
_CENTRED: dict[str, tuple[tuple[float, float], tuple[float, float], float]] = {
    "dining": ((0.70, 0.78), (0.95, 1.4), 3),
    "bistro": ((0.70, 0.76), (0.6, 0.8), 2),
    "bar": ((0.98, 1.1), (0.55, 0.75), 1),
    "coffee": ((0.36, 0.46), (0.7, 1.0), 1.5),
    "side": ((0.45, 0.62), (0.4, 0.55), 1.5),
}


def _centred(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A round, oval or square top on something in the middle."""
    use = pick(rng, {name: weight for name, (_, _, weight) in _CENTRED.items()})
    height, width = (between(rng, *span) for span in _CENTRED[use][:2])
    shape = pick(rng, {"round": 5, "square": 1.5, "rounded": 1.5, "octagon": 0.7})
    longest = max(width, height)
    depth = width * (between(rng, 0.6, 0.85) if shape == "rounded" else 1.0)
    top = Top(width, depth, height, longest * between(rng, 0.03, 0.07))
    parts = _top(rng, shape, top)
    stand, make_stand = pick_from(rng, _MIDDLES)
    foot = Footprint(width * 0.8, depth * 0.8, top.under, longest * between(rng, 0.05, 0.08))
    return parts + make_stand(rng, foot), f"{use}-{shape}/{stand}"


def _claw(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Turned column on three or four curved feet."""
    t = np.linspace(0.12, 1, 13)
    radius = 0.75 * foot.thickness * (0.8 + 0.3 * np.cos(2 * np.pi * whole(rng, 1, 3) * t) + 0.25 * (1 - t))
    column = lathe(np.stack([radius, t * (foot.height + supports.OVERLAP)], axis=1), section=ellipse(16))
    reach = max(foot.width, foot.depth) * between(rng, 0.36, 0.48)
    rise, thick = foot.height * between(rng, 0.2, 0.4), foot.thickness * between(rng, 0.75, 1.0)
    return [column, *supports.curved_feet(pick(rng, {3: 1, 4: 2}), reach, rise, thick)]


def _turned_block(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """A drum, cone or hourglass, round or faceted."""
    half, t = min(foot.width, foot.depth) / 2, np.linspace(0, 1, 9)
    wide, slim = half * between(rng, 0.7, 1.0), half * between(rng, 0.2, 0.5)
    _, radius = pick_from(
        rng,
        {
            "drum": (wide * (1 + between(rng, -0.15, 0.1) * np.sin(np.pi * t)), 1.2),
            "cone": (wide + (slim - wide) * t ** between(rng, 0.6, 1.2), 1),
            "hourglass": (slim + (wide - slim) * np.abs(2 * t - 1) ** between(rng, 1.2, 2.0), 1),
        },
    )
    section = ellipse(pick(rng, {24: 3, 8: 1, 4: 1}))
    return [lathe(np.stack([radius, t * (foot.height + supports.OVERLAP)], axis=1), section=section)]


_MIDDLES: dict[str, tuple[supports.Support, float]] = {
    "disc": (supports.disc_pedestal, 4),
    "claw": (_claw, 3),
    "cross-foot": (supports.cross_foot, 1),
    "block": (_turned_block, 3),
    "legs": (supports.straight_legs, 2),
    "splayed": (supports.splayed_legs, 2),
}


# --- others -------------------------------------------------------------------------------------------------


def _one_thickness(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Top and legs of one thickness: a parsons table, a waterfall, a Z or a C."""
    width, depth, height = between(rng, 0.5, 1.6), between(rng, 0.45, 0.9), between(rng, 0.38, 0.76)
    thick = max(width, height) * between(rng, 0.055, 0.1)
    under = height - 0.01
    kind = pick(rng, {"parsons": 2, "waterfall": 2, "z": 1, "c": 1})
    parts = [box((width, thick, depth), (0, height - thick / 2, 0))]
    if kind == "parsons":
        corners = Footprint(width, depth, height, thick).corners()
        parts += [box((thick, under, thick), (x, under / 2, z)) for x, z in corners]
    elif kind == "waterfall":
        parts += with_mirror([box((thick, under, depth), (width / 2 - thick / 2, under / 2, 0))])
        if chance(rng, 0.4):
            parts.append(box((width, thick * 0.8, depth), (0, between(rng, 0.15, 0.4) * height, 0)))
    else:
        parts.append(box((width, thick, depth), (0, thick / 2, 0)))
        x = (width - thick) / 2
        foot, head = (-x, thick / 2, 0), (x if kind == "z" else -x, height - thick / 2, 0)
        parts.append(bar(foot, head, (thick, depth), square=True, up=(0, 0, 1)))
    return parts, f"{kind}/one-thickness"


def _shelved(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Two or three levels between posts: side table, trolley, media table."""
    width, depth, height = between(rng, 0.5, 1.4), between(rng, 0.4, 0.6), between(rng, 0.45, 0.8)
    longest = max(width, height)
    post, board = longest * between(rng, 0.05, 0.08), longest * between(rng, 0.035, 0.06)
    rounded = chance(rng, 0.4)
    plan = outline(width, depth, exponent=5.0 if rounded else None, sides=40)
    levels = np.linspace(between(rng, 0.1, 0.25) * height, height - board, whole(rng, 2, 3))
    parts = [slab(plan, float(y), float(y) + board, edge=board * 0.3 if rounded else 0.0) for y in levels]
    for x, z in Footprint(width, depth, height, post).corners(0.9 if rounded else 0.5):
        parts.append(bar((x, 0, z), (x, height - 0.01, z), post, square=not rounded))
    if chance(rng, 0.4):
        rear = (width * 0.95, levels[1] - levels[0], 0.04)
        parts.append(box(rear, (0, (levels[0] + levels[1]) / 2, -depth * 0.45)))
    return parts, f"shelves-{len(levels)}/posts"


def _picnic(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Boarded top with two benches on A-frames."""
    plank, beam = between(rng, 0.05, 0.075), between(rng, 0.07, 0.1)
    top = Top(between(rng, 1.4, 1.9), between(rng, 0.65, 0.8), between(rng, 0.7, 0.78), plank)
    reach, seat = top.depth / 2 + between(rng, 0.28, 0.38), between(rng, 0.4, 0.46)
    x = top.width * between(rng, 0.3, 0.38)
    frame = [box((beam * 0.7, beam, 2 * reach + 0.2), (x, seat - plank * 0.9, 0))]
    for side in (1, -1):
        head, foot = (x, top.under, side * top.depth * 0.25), (x, beam * 0.2, side * reach * 0.95)
        frame.append(bar(head, foot, beam, square=True, up=(1, 0, 0)))
    benches = [box((top.width, plank, 0.27), (0, seat, side * reach)) for side in (1, -1)]
    return [*tops.boarded_top(top, whole(rng, 4, 6)), *benches, *with_mirror(frame)], "picnic/a-frames"
