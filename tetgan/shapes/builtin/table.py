"""Tables: dining, coffee, side and console tables, desks with drawers, workbenches."""

import numpy as np
from jaxtyping import Float

from tetgan.shapes.builtin import supports
from tetgan.shapes.builtin.draws import between, chance, pick, whole
from tetgan.shapes.builtin.parts import (
    Part,
    bar,
    box,
    ellipse,
    lathe,
    outline,
    rounded_box,
    sheet,
    slab,
    with_mirror,
)
from tetgan.shapes.builtin.supports import Footprint

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
    return pick(rng, {_oblong: 42, _centred: 24, _desk: 15, _parsons: 7, _nested_shelves: 7, _picnic: 5})(rng)


def _oblong(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A top on legs at its corners or ends."""
    use = pick(rng, {"dining": 4, "coffee": 3, "side": 2, "console": 1.5})
    width, depth, height = {
        "dining": (between(rng, 1.1, 2.0), between(rng, 0.75, 1.0), between(rng, 0.70, 0.78)),
        "coffee": (between(rng, 0.85, 1.35), between(rng, 0.5, 0.8), between(rng, 0.36, 0.5)),
        "side": (between(rng, 0.45, 0.65), between(rng, 0.42, 0.62), between(rng, 0.5, 0.7)),
        "console": (between(rng, 1.0, 1.4), between(rng, 0.32, 0.42), between(rng, 0.75, 0.88)),
    }[use]
    longest = max(width, height)
    leg, thick = longest * between(rng, 0.042, 0.075), longest * between(rng, 0.03, 0.07)
    top = pick(rng, {"rectangle": 4, "rounded": 2, "oval": 1.5, "planks": 1, "glass": 0.7})
    stand = pick(rng, {name: weight for name, (_, weight) in SUPPORTS.items()})
    inset = 0.7 if top == "oval" else between(rng, 0.86, 1.0)
    if stand == "trestles":
        inset = between(rng, 0.7, 0.85)
    foot = Footprint(width * inset, depth * min(inset, 0.94), height - thick, leg)
    parts = [*_top(rng, top, width, depth, height, thick), *SUPPORTS[stand][0](rng, foot)]
    if stand in ("legs", "turned", "splayed") and use != "dining" and chance(rng, 0.4):
        parts.append(
            box((foot.width * 0.98, thick * 0.7, foot.depth * 0.95), (0, height * between(rng, 0.2, 0.4), 0))
        )
        stand += "-shelf"
    if stand in ("legs", "turned") and chance(rng, 0.3):
        parts += _drawer_row(rng, foot)
        stand += "-drawer"
    return parts, f"{use}-{top}/{stand}"


def _top(
    rng: np.random.Generator, kind: str, width: float, depth: float, height: float, thick: float
) -> list[Part]:
    under = height - thick
    if kind == "planks":
        count = whole(rng, 4, 6)
        pitch = depth / count
        boards = [
            box((width, thick, pitch * 0.9), (0, height - thick / 2, -depth / 2 + (i + 0.5) * pitch))
            for i in range(count)
        ]
        return boards + with_mirror(
            [box((thick, thick, depth * 0.96), (width * 0.42, under - thick * 0.2, 0))]
        )
    if kind == "glass":
        # A pane without thickness in a frame, as many models have it.
        x, z = np.meshgrid([-width / 2, width / 2], [depth / 2, -depth / 2], indexing="ij")
        pane = sheet(np.stack([x, np.full((2, 2), height - thick * 0.3), z], axis=-1))
        side = box((thick, thick, depth), (width / 2 - thick / 2, height - thick / 2, 0))
        ends = [box((width, thick, thick), (0, height - thick / 2, s * (depth - thick) / 2)) for s in (1, -1)]
        return [pane, *with_mirror([side]), *ends]
    plan = _plan(rng, kind, width, depth)
    return [slab(plan, under, height, edge=thick * between(rng, 0.0, 0.45))]


def _plan(rng: np.random.Generator, kind: str, width: float, depth: float) -> Float[np.ndarray, "S 2"]:
    exponents = {"rectangle": None, "oval": 2.0, "round": 2.0, "square": None}
    exponent = exponents.get(kind, between(rng, 3.0, 9.0))
    return outline(width, depth, exponent=exponent, sides=40)


def _drawer_row(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """A shallow box under the top with fronts and knobs."""
    tall, count = foot.height * between(rng, 0.14, 0.22), whole(rng, 1, 3)
    y, front = foot.height - tall / 2, foot.depth / 2
    case = box((foot.width - foot.thickness, tall, foot.depth - foot.thickness * 0.6), (0, y, 0))
    width = (foot.width - 2 * foot.thickness) / count
    parts = [case]
    for i in range(count):
        x = (i + 0.5 - count / 2) * width
        parts.append(box((width * 0.92, tall * 0.78, 0.02), (x, y, front - foot.thickness * 0.3 + 0.01)))
        parts.append(_knob(x, y, front - foot.thickness * 0.3 + 0.02))
    return parts


def _knob(x: float, y: float, z: float) -> Part:
    return bar((x, y, z - 0.005), (x, y, z + 0.03), 0.045, taper=0.8)


def _centred(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A round, oval or square top on something in the middle."""
    use = pick(rng, {"dining": 3, "bistro": 2, "bar": 1, "coffee": 1.5, "side": 1.5})
    low, high = {
        "dining": (0.70, 0.78),
        "bistro": (0.70, 0.76),
        "bar": (0.98, 1.1),
        "coffee": (0.36, 0.46),
        "side": (0.45, 0.62),
    }[use]
    near, far = {
        "dining": (0.95, 1.4),
        "bistro": (0.6, 0.8),
        "bar": (0.55, 0.75),
        "coffee": (0.7, 1.0),
        "side": (0.4, 0.55),
    }[use]
    height, width = between(rng, low, high), between(rng, near, far)
    top = pick(rng, {"round": 5, "square": 1.5, "rounded": 1.5, "octagon": 0.7})
    depth = width * (between(rng, 0.6, 0.85) if top == "rounded" else 1.0)
    longest = max(width, height)
    thick = longest * between(rng, 0.03, 0.07)
    plan = ellipse(8) * width / 2 if top == "octagon" else _plan(rng, top, width, depth)
    parts = [slab(plan, height - thick, height, edge=thick * between(rng, 0.0, 0.45))]
    stand = pick(
        rng,
        {"disc": 4, "claw": 3, "star": 1, "drum": 1.2, "legs": 2, "splayed": 2, "cone": 1, "hourglass": 1},
    )
    foot = Footprint(width * 0.8, depth * 0.8, height - thick, longest * between(rng, 0.05, 0.08))
    return parts + _middle(rng, stand, foot), f"{use}-{top}/{stand}"


def _middle(rng: np.random.Generator, kind: str, foot: Footprint) -> list[Part]:
    """Support of a centred table."""
    half, top = min(foot.width, foot.depth) / 2, foot.height + supports.OVERLAP
    if kind in ("legs", "splayed"):
        narrow = Footprint(foot.width * 0.88, foot.depth * 0.88, foot.height, foot.thickness)
        return (supports.straight_legs if kind == "legs" else supports.splayed_legs)(rng, narrow)
    if kind == "disc":
        return supports.disc_pedestal(rng, foot)
    if kind == "claw":
        return _claw(rng, foot)
    if kind == "star":
        return supports.cross_foot(rng, foot)
    wide, slim = half * between(rng, 0.7, 1.0), half * between(rng, 0.2, 0.5)
    t = np.linspace(0, 1, 9)
    radius = {
        "drum": half * between(rng, 0.5, 0.95) * (1 + between(rng, -0.1, 0.15) * np.sin(np.pi * t)),
        "cone": wide + (slim - wide) * t ** between(rng, 0.6, 1.2),
        "hourglass": slim + (wide - slim) * np.abs(2 * t - 1) ** between(rng, 1.2, 2.0),
    }[kind]
    section = ellipse(pick(rng, {24: 3, 8: 1, 4: 1}))
    return [lathe(np.stack([radius, t * top], axis=1), section=section)]


def _claw(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Turned column on three or four curved feet."""
    column, top = foot.thickness * 0.75, foot.height + supports.OVERLAP
    t = np.linspace(0.12, 1, 13)
    radius = column * (0.8 + 0.3 * np.cos(2 * np.pi * whole(rng, 1, 3) * t) + 0.25 * (1 - t))
    parts = [lathe(np.stack([radius, t * top], axis=1), section=ellipse(16))]
    legs, reach = pick(rng, {3: 1, 4: 2}), max(foot.width, foot.depth) * between(rng, 0.36, 0.48)
    rise = foot.height * between(rng, 0.2, 0.4)
    return parts + supports.curved_feet(legs, reach, rise, foot.thickness * between(rng, 0.75, 1.0))


def _desk(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A writing desk: drawers on one or both sides, legs on the other."""
    width, depth, height = between(rng, 1.1, 1.7), between(rng, 0.55, 0.8), between(rng, 0.72, 0.78)
    thick, leg = between(rng, 0.04, 0.08), between(rng, 0.06, 0.1)
    under = height - thick
    sides = pick(rng, {"both": 1, "one": 2})
    block, feet = between(rng, 0.32, 0.46), between(rng, 0.0, 0.15)
    tall = between(rng, 0.45, 1.0) * (under - feet) if chance(rng, 0.4) else under - feet
    case = _drawer_case(rng, width / 2 - block / 2 - 0.02, block, depth * 0.94, under - tall, under)
    parts = [box((width, thick, depth), (0, height - thick / 2, 0)), *case]
    foot = Footprint(width - 0.04, depth * 0.94, under, leg)
    if sides == "both":
        parts += [part.mirrored() for part in case]
    stand = pick(rng, {"legs": 2, "panel": 1})
    if under - tall > 0.06:
        parts += supports.plain_legs(rng, foot)
        stand = "legs"
    elif sides == "one":
        parts += _open_side(foot, stand, leg)
    if chance(rng, 0.5):
        parts.append(
            box((width * 0.9, under * between(rng, 0.3, 0.6), 0.04), (0, under * 0.72, -depth * 0.44))
        )
    if chance(rng, 0.2):
        parts += _hutch(rng, width, depth, height)
    return parts, f"desk-{sides}/{stand}"


def _drawer_case(
    rng: np.random.Generator, x: float, width: float, depth: float, low: float, high: float
) -> list[Part]:
    """A chest with fronts standing out a little, each with a knob or a handle."""
    count = max(1, round((high - low) / between(rng, 0.15, 0.26)))
    parts = [box((width, high - low + 0.01, depth), (x, (high + low) / 2, 0))]
    pitch = (high - low) / count
    knobs = chance(rng, 0.5)
    for i in range(count):
        y = low + (i + 0.5) * pitch
        parts.append(box((width * 0.9, pitch * 0.86, 0.02), (x, y, depth / 2 + 0.008)))
        handle = box((width * 0.35, 0.025, 0.03), (x, y, depth / 2 + 0.028))
        parts.append(_knob(x, y, depth / 2 + 0.015) if knobs else handle)
    return parts


def _open_side(foot: Footprint, kind: str, leg: float) -> list[Part]:
    """What carries the end without drawers, at -x."""
    if kind == "panel":
        return [
            box(
                (leg * 0.7, foot.height + 0.01, foot.depth),
                (-foot.width / 2 + leg * 0.35, foot.height / 2, 0),
            )
        ]
    x, z = foot.width / 2 - leg / 2, foot.depth / 2 - leg / 2
    return [box((leg, foot.height + 0.01, leg), (-x, foot.height / 2, s * z)) for s in (1, -1)]


def _hutch(rng: np.random.Generator, width: float, depth: float, height: float) -> list[Part]:
    """Shelves standing at the rear of a desk."""
    tall, deep, board = between(rng, 0.25, 0.5), depth * between(rng, 0.3, 0.4), 0.045
    z = -depth / 2 + deep / 2
    side = box((board, tall + 0.01, deep), (width / 2 - board, height + tall / 2, z))
    levels = [tall] if tall < 0.35 else [tall / 2, tall]
    return [
        *with_mirror([side]),
        *(box((width - board, board, deep), (0, height + y - board / 2, z)) for y in levels),
    ]


def _parsons(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Top and legs of one thickness; or a waterfall or a cube."""
    width, depth, height = between(rng, 0.5, 1.6), between(rng, 0.45, 0.9), between(rng, 0.38, 0.76)
    thick = max(width, height) * between(rng, 0.055, 0.1)
    kind = pick(rng, {"parsons": 2, "waterfall": 2, "z": 1, "c": 1})
    parts = [box((width, thick, depth), (0, height - thick / 2, 0))]
    if kind == "parsons":
        for x, z in Footprint(width, depth, height, thick).corners():
            parts.append(box((thick, height - 0.01, thick), (x, (height - 0.01) / 2, z)))
    elif kind == "waterfall":
        parts += with_mirror(
            [box((thick, height - 0.01, depth), (width / 2 - thick / 2, (height - 0.01) / 2, 0))]
        )
        if chance(rng, 0.4):
            parts.append(box((width, thick * 0.8, depth), (0, between(rng, 0.15, 0.4) * height, 0)))
    else:
        parts.append(box((width, thick, depth), (0, thick / 2, 0)))
        lean = width - thick if kind == "z" else 0.0
        foot, head = (
            (-width / 2 + thick / 2, thick * 0.5, 0),
            (-width / 2 + thick / 2 + lean, height - thick * 0.5, 0),
        )
        parts.append(bar(foot, head, (thick, depth), square=True, up=(0, 0, 1)))
    return parts, f"{kind}/one-thickness"


def _nested_shelves(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Two or three levels between posts: side table, trolley, media table."""
    width, depth, height = between(rng, 0.5, 1.4), between(rng, 0.4, 0.6), between(rng, 0.45, 0.8)
    longest = max(width, height)
    post, board = longest * between(rng, 0.05, 0.08), longest * between(rng, 0.035, 0.06)
    round_corners = chance(rng, 0.4)
    levels = np.linspace(between(rng, 0.1, 0.25) * height, height - board, whole(rng, 2, 3))
    parts = []
    for y in levels:
        if round_corners:
            parts.append(
                slab(
                    outline(width, depth, exponent=5.0, sides=40),
                    float(y),
                    float(y) + board,
                    edge=board * 0.3,
                )
            )
        else:
            parts.append(box((width, board, depth), (0, float(y) + board / 2, 0)))
    for x, z in Footprint(width, depth, height, post).corners(0.9 if round_corners else 0.5):
        parts.append(bar((x, 0, z), (x, height - 0.01, z), post, square=not round_corners))
    if chance(rng, 0.4):
        parts.append(
            rounded_box(
                (width * 0.95, levels[1] - levels[0], 0.04),
                (0, (levels[0] + levels[1]) / 2, -depth * 0.45),
                0.01,
            )
        )
    return parts, f"shelves-{len(levels)}/posts"


def _picnic(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Planked top with two benches on A-frames."""
    width, depth, height = between(rng, 1.4, 1.9), between(rng, 0.65, 0.8), between(rng, 0.7, 0.78)
    plank, beam = between(rng, 0.05, 0.075), between(rng, 0.07, 0.1)
    reach, seat = depth / 2 + between(rng, 0.28, 0.38), between(rng, 0.4, 0.46)
    parts = _top(rng, "planks", width, depth, height, plank)
    parts += [box((width, plank, 0.27), (0, seat, s * reach)) for s in (1, -1)]
    x = width * between(rng, 0.3, 0.38)
    frame = [
        bar((x, height - plank, s * depth * 0.25), (x, 0, s * reach * 0.95), beam, square=True, up=(1, 0, 0))
        for s in (1, -1)
    ]
    frame.append(box((beam * 0.7, beam, 2 * reach + 0.2), (x, seat - plank * 0.9, 0)))
    return parts + with_mirror(frame), "picnic/a-frames"
