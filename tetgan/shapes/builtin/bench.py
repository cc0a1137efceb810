"""Benches: park, garden, backless, stone, pew, padded and storage benches."""

import numpy as np

from tetgan.shapes.builtin import backs, supports, tops
from tetgan.shapes.builtin.arms import ArmRoom, loop_arms, post_arms, wall_arms
from tetgan.shapes.builtin.draws import between, chance, pick, pick_from, whole
from tetgan.shapes.builtin.parts import (
    SQUARE,
    Part,
    box,
    outline,
    panel,
    rounded_box,
    slab,
    sweep,
    tube,
    with_mirror,
)
from tetgan.shapes.builtin.tops import Top

_ARMS = {"post-arms": post_arms, "loop-arms": loop_arms, "wall-arms": wall_arms}


def make_bench(rng: np.random.Generator) -> tuple[list[Part], str]:
    """One bench and its structural kind."""
    kinds = {_park: 28, _garden: 24, _backless: 24, _stone: 9, _pew: 9, _padded: 9, _storage: 6}
    return pick(rng, kinds)(rng)


def _arms(rng: np.random.Generator, kind: str, top: Top, thickness: float) -> list[Part]:
    """Arm rests at both ends of a seat."""
    if kind == "no-arms":
        return []
    room = ArmRoom(
        x=top.width / 2 - thickness * 0.5,
        seat=top.height,
        height=top.height + between(rng, 0.17, 0.24),
        back=-top.depth / 2 - 0.02,
        front=top.depth / 2,
        thickness=thickness,
    )
    return _ARMS[kind](rng, room)


# --- with boards along --------------------------------------------------------------------------------------


def _park(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Boards along the bench on iron, posts or blocks, seat and back."""
    top = Top(
        between(rng, 1.2, 1.9), between(rng, 0.42, 0.56), between(rng, 0.40, 0.47), between(rng, 0.035, 0.055)
    )
    plane = backs.BackPlane(
        width=top.width,
        height=between(rng, 0.34, 0.48),
        seat=top.height,
        z=-top.depth / 2 - 0.01,
        tilt=between(rng, 8.0, 22.0),
    )
    rungs = whole(rng, 2, 4)
    parts = [*tops.long_boards(top, whole(rng, 3, 5)), *_park_back(rng, plane, rungs, top.thick)]
    ends = pick(rng, {"iron": 3, "blocks": 1, "posts": 2})
    stations = [1, -1] if top.width < 1.6 else [1, 0, -1]
    outer = top.width / 2 - between(rng, 0.08, 0.2)
    for station in stations:
        parts += _park_end(ends, station * outer, top, plane)
    arm = pick(rng, {"no-arms": 5, "post-arms": 2, "loop-arms": 2})
    return parts + _arms(rng, arm, top, 0.06), f"park-{rungs}-boards/{ends}/{arm}"


def _park_back(rng: np.random.Generator, plane: backs.BackPlane, count: int, thick: float) -> list[Part]:
    """Boards on edge, following the lean of the back."""
    half = np.array([thick / 2, plane.height / count * between(rng, 0.30, 0.36)])
    upward = plane.point(0, 1) - plane.point(0, 0)
    places = (np.arange(count) + 0.65) / count
    return [sweep(plane.point([-1, 1], s), SQUARE * half, up=upward) for s in places]


def _park_end(kind: str, x: float, top: Top, plane: backs.BackPlane) -> list[Part]:
    """One upright frame carrying seat and back."""
    thick, half, under = 0.065, top.depth / 2, top.under
    path = plane.point(0, np.linspace(-0.25, 0.97, 4)) + np.array([x, 0, -0.03])
    spine = tube(path, thick, square=True, up=(0, 0, 1))
    if kind == "blocks":
        return [box((0.14, under + 0.01, top.depth * 0.9), (x, under / 2, 0)), spine]
    bearer = box((thick, thick, top.depth), (x, under - thick * 0.3, 0))
    if kind == "posts":
        legs = [box((thick, under, thick), (x, under / 2, z)) for z in (half - 0.05, 0.03 - half)]
        return [*legs, bearer, spine]
    t = np.linspace(0, 1, 10)
    sway, fall = 0.06 * np.sin(np.pi * t), under * (1 - t)
    profiles = (half - 0.08 - sway + 0.08 * t, 0.08 - half + sway - 0.12 * t)
    legs = [tube(np.stack([np.full(10, x), fall, z], 1), thick * 0.9, up=(1, 0, 0)) for z in profiles]
    return [*legs, bearer, spine]


_GARDEN_BACKS: dict[str, tuple[backs.Back, float]] = {
    "slatted": (backs.slatted_back, 4),
    "spindle": (backs.spindle_back, 3),
    "ladder": (backs.ladder_back, 2),
    "cross": (backs.cross_back, 1),
    "lattice": (backs.lattice_back, 2),
    "solid": (backs.solid_back, 2),
    "open": (backs.open_back, 1),
}

_GARDEN_STANDS: dict[str, tuple[supports.Support, float]] = {
    "legs": (supports.straight_legs, 4),
    "splayed": (supports.splayed_legs, 1.5),
    "turned": (supports.turned_legs, 1),
    "curved": (supports.curved_legs, 1),
    "sled": (supports.sled_runners, 1),
}


def _garden(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A wide chair: the same backs, legs and arms, stretched."""
    top = Top(
        between(rng, 0.95, 1.7), between(rng, 0.45, 0.58), between(rng, 0.40, 0.47), between(rng, 0.05, 0.08)
    )
    leg = between(rng, 0.06, 0.085)
    plane = backs.BackPlane(
        width=top.width - leg,
        height=between(rng, 0.36, 0.56),
        seat=top.height,
        z=-top.depth / 2 + leg / 2,
        tilt=between(rng, 4.0, 14.0),
        bow=between(rng, 0.0, 0.06),
    )
    back, make_back = pick_from(rng, _GARDEN_BACKS)
    stand, make_stand = pick_from(rng, _GARDEN_STANDS)
    arm = pick(rng, {"post-arms": 5, "no-arms": 3, "wall-arms": 1, "loop-arms": 1})
    seat = tops.boarded_top(top, 4) if chance(rng, 0.5) else tops.plank_top(top)
    foot = supports.Footprint(top.width, top.depth, top.under + 0.01, leg)
    parts = [*seat, *make_back(rng, plane, leg * 0.85), *make_stand(rng, foot)]
    return parts + _arms(rng, arm, top, leg * 0.9), f"garden-{back}/{stand}/{arm}"


# --- without a back -----------------------------------------------------------------------------------------

_STANDS: dict[str, tuple[supports.Support, float]] = {
    "legs": (supports.straight_legs, 4),
    "splayed": (supports.splayed_legs, 3),
    "panels": (supports.side_panels, 3),
    "trestles": (supports.trestles, 2),
    "sled": (supports.sled_runners, 2),
    "crossed": (supports.crossed_legs, 1),
    "turned": (supports.turned_legs, 1),
    "curved": (supports.curved_legs, 1),
    "hairpin": (supports.hairpin_legs, 1),
}


def _backless(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A top on a support, nothing else."""
    top = Top(
        between(rng, 1.0, 1.8), between(rng, 0.32, 0.45), between(rng, 0.40, 0.48), between(rng, 0.05, 0.1)
    )
    stand, make_stand = pick_from(rng, _STANDS)
    shape = pick(rng, {"plank": 3, "boards": 2, "rounded": 2, "hollow": 1})
    inset = between(rng, 0.0, 0.25) if stand in ("panels", "trestles") else between(rng, 0.0, 0.08)
    foot = supports.Footprint(top.width * (1 - inset), top.depth * 0.92, top.under, between(rng, 0.06, 0.1))
    return _bench_top(rng, shape, top) + make_stand(rng, foot), f"backless-{shape}/{stand}/no-arms"


def _bench_top(rng: np.random.Generator, shape: str, top: Top) -> list[Part]:
    if shape == "plank":
        return tops.plank_top(top)
    if shape == "boards":
        return tops.boarded_top(top, whole(rng, 2, 4))
    if shape == "hollow":
        return tops.hollow_top(rng, top)
    return tops.shaped_top(rng, top, between(rng, 2.2, 6.0))


def _padded(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Upholstered bench, perhaps with scrolled ends."""
    width, depth, seat = between(rng, 0.95, 1.5), between(rng, 0.38, 0.5), between(rng, 0.42, 0.5)
    pad, leg = between(rng, 0.1, 0.16), between(rng, 0.055, 0.085)
    parts = [
        rounded_box((width, pad, depth), (0, seat - pad / 2, 0), 0.045, bulge=(0, 0.02, 0)),
        box((width * 0.97, 0.06, depth * 0.95), (0, seat - pad - 0.02, 0)),
    ]
    ends = "scrolls" if chance(rng, 0.5) else "no-arms"
    parts += _scrolls(rng, width, depth, seat) if ends == "scrolls" else []
    foot = supports.Footprint(width * 0.95, depth * 0.92, seat - pad - 0.04, leg)
    stand, make_stand = pick_from(
        rng, {name: _STANDS[name] for name in ("legs", "turned", "curved", "splayed")}
    )
    return parts + make_stand(rng, foot), f"padded/{stand}/{ends}"


def _scrolls(rng: np.random.Generator, width: float, depth: float, seat: float) -> list[Part]:
    """Ends that rise and roll outwards."""
    t, z = np.linspace(0, 1, 8), np.linspace(depth / 2, -depth / 2, 4)[:, None]
    x = width / 2 - 0.05 + between(rng, 0.05, 0.12) * t**2
    y = seat - 0.08 + between(rng, 0.22, 0.32) * t
    return with_mirror([panel(np.stack(np.broadcast_arrays(x, y, z), axis=-1), 0.08)])


# --- solid --------------------------------------------------------------------------------------------------


def _stone(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A thick slab on blocks, straight or curved; sometimes with a thick back."""
    top = Top(
        between(rng, 1.0, 1.8), between(rng, 0.38, 0.55), between(rng, 0.40, 0.5), between(rng, 0.09, 0.17)
    )
    bend = between(rng, 0.1, 0.3) if chance(rng, 0.3) else 0.0  # metres the ends come forward
    u = np.linspace(-1, 1, 17)[:, None]
    z = np.linspace(top.depth / 2, -top.depth / 2, 4) + bend * u**2
    y = np.full(z.shape, top.height - top.thick / 2)
    parts = [panel(np.stack(np.broadcast_arrays(u * top.width / 2, y, z), axis=-1), top.thick)]
    blocks = pick(rng, {"two": 3, "one": 1, "round": 1})
    parts += _blocks(rng, blocks, top, bend)
    back = "wall" if bend == 0 and chance(rng, 0.4) else "no-back"
    if back == "wall":
        tall = between(rng, 0.3, 0.45) + top.thick
        middle = (0, top.under + tall / 2, -top.depth / 2 + top.thick * 0.45)
        parts.append(box((top.width, tall, top.thick * 0.9), middle))
    return parts, f"stone-{back}/{blocks}-blocks/no-arms"


def _blocks(rng: np.random.Generator, kind: str, top: Top, bend: float) -> list[Part]:
    tall = top.under + 0.01
    if kind == "one":
        return [box((top.width * between(rng, 0.5, 0.9), tall, top.depth * 0.7), (0, tall / 2, bend * 0.2))]
    place = between(rng, 0.6, 0.85)
    plan = outline(between(rng, 0.14, 0.26), top.depth * 0.85, exponent=8.0 if kind == "two" else 2.5)
    centre = (place * top.width / 2, bend * place**2)
    return with_mirror([slab(plan, 0, tall, edge=between(rng, 0.0, 0.04), centre=centre)])


def _pew(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Church pew: shaped boards at both ends, solid seat and back."""
    width, depth, seat = between(rng, 1.2, 2.0), between(rng, 0.45, 0.58), between(rng, 0.42, 0.48)
    tall, tilt, board = between(rng, 0.42, 0.56), between(rng, 4.0, 14.0), between(rng, 0.045, 0.07)
    inner = width - board
    plane = backs.BackPlane(inner, tall, seat, -depth / 2 + 0.05, tilt)
    low = -0.95 * seat / tall if chance(rng, 0.4) else -0.1
    parts = [
        panel(plane.grid(np.linspace(-1, 1, 5), low, 1.0, rows=4), board),
        box((inner, board, depth - 0.05), (0, seat - board / 2, 0.02)),
    ]
    if chance(rng, 0.5):
        parts.append(box((inner, seat, board), (0, seat / 2, between(rng, -0.2, 0.12) * depth)))
    lean = np.tan(np.radians(tilt)) * tall
    s = np.linspace(0, 1, 13)[:, None]
    arm = seat + between(rng, 0.1, 0.24)
    fall = np.clip(1 - s * between(rng, 1.8, 3.0), 0, 1) ** between(rng, 0.6, 1.6)
    y = (arm + (seat + tall + 0.03 - arm) * fall) * np.linspace(0, 1, 4)
    z = depth / 2 - (depth + lean) * (1 - s)
    end = panel(np.stack(np.broadcast_arrays(width / 2, y, z), axis=-1)[::-1], board)
    return parts + with_mirror([end]), "pew/end-boards/wall-arms"


def _storage(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Hall bench: a chest with a lid, a back and perhaps arms."""
    top = Top(
        between(rng, 0.95, 1.4),
        between(rng, 0.42, 0.52),
        between(rng, 0.42, 0.48),
        between(rng, 0.045, 0.065),
    )
    feet = between(rng, 0.0, 0.09)
    chest = (top.width - 0.05, top.under - feet + 0.01, top.depth - 0.04)
    plane = backs.BackPlane(
        width=top.width - top.thick,
        height=between(rng, 0.38, 0.6),
        seat=top.height,
        z=-top.depth / 2 + 0.03,
        tilt=between(rng, 0.0, 6.0),
    )
    back, make_back = pick_from(
        rng,
        {"solid": (backs.solid_back, 2), "slatted": (backs.slatted_back, 1), "caned": (backs.caned_back, 1)},
    )
    parts = [
        box(chest, (0, (top.under + feet) / 2, 0)),
        *tops.plank_top(top),
        *make_back(rng, plane, top.thick),
    ]
    stand = "feet" if feet > 0.03 else "plinth"
    if stand == "feet":
        parts += supports.plain_legs(rng, supports.Footprint(chest[0], chest[2], feet, 0.09))
    arm = pick(rng, {"post-arms": 1, "wall-arms": 1, "no-arms": 1})
    return parts + _arms(rng, arm, top, top.thick), f"storage-{back}/{stand}/{arm}"
