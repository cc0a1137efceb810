"""Benches: park, plank, stone, pew, garden, padded and storage benches."""

import numpy as np

from tetgan.shapes.builtin import backs, supports
from tetgan.shapes.builtin.arms import ArmRoom, loop_arms, post_arms, wall_arms
from tetgan.shapes.builtin.draws import between, chance, pick, whole
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


def make_bench(rng: np.random.Generator) -> tuple[list[Part], str]:
    """One bench and its structural kind."""
    return pick(rng, {_park: 28, _garden: 24, _backless: 24, _stone: 9, _pew: 9, _padded: 9, _storage: 6})(
        rng
    )


def _park(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Boards along the bench on bent iron or block ends, seat and back."""
    width, depth = between(rng, 1.2, 1.9), between(rng, 0.42, 0.56)
    seat, tall, tilt = between(rng, 0.40, 0.47), between(rng, 0.34, 0.48), between(rng, 8, 22)
    plank, treads, rungs = between(rng, 0.035, 0.055), whole(rng, 3, 5), whole(rng, 2, 4)
    parts = _long_boards(width, depth, seat, plank, treads)
    plane = backs.BackPlane(width, tall, seat, -depth / 2 - 0.01, tilt)
    pitch = tall / rungs
    for s in (np.arange(rungs) + 0.65) / rungs:
        section = SQUARE * np.array([plank / 2, pitch * between(rng, 0.30, 0.36)])
        parts.append(
            sweep(plane.point(np.array([-1.0, 1.0]), s), section, up=plane.point(0, 1) - plane.point(0, 0))
        )
    ends = pick(rng, {"iron": 3, "blocks": 1, "posts": 2})
    stations = np.array([1.0, -1.0]) if width < 1.6 else np.array([1.0, 0.0, -1.0])
    for x in stations * (width / 2 - between(rng, 0.08, 0.2)):
        parts += _park_end(ends, x, depth, seat - plank, plane)
    arm = "no-arms"
    if chance(rng, 0.45):
        arm = pick(rng, {"post-arms": 1, "loop-arms": 1})
        room = ArmRoom(
            width / 2 - 0.05, seat, seat + between(rng, 0.18, 0.24), -depth / 2 - 0.04, depth / 2, 0.06
        )
        parts += (post_arms if arm == "post-arms" else loop_arms)(rng, room)
    return parts, f"park-{rungs}-boards/{ends}/{arm}"


def _park_end(kind: str, x: float, depth: float, under: float, plane: backs.BackPlane) -> list[Part]:
    """One upright frame carrying seat and back."""
    thick, half = 0.065, depth / 2
    spine = tube(
        plane.point(0, np.linspace(-0.25, 0.97, 4)) + [x, 0, -0.03], thick, square=True, up=(0, 0, 1)
    )
    if kind == "blocks":
        return [box((0.14, under + 0.01, depth * 0.9), (x, under / 2, 0)), spine]
    bearer = box((thick, thick, depth), (x, under - thick * 0.3, 0))
    if kind == "posts":
        legs = [box((thick, under, thick), (x, under / 2, z)) for z in (half - 0.05, -half + 0.03)]
        return [*legs, bearer, spine]
    t = np.linspace(0, 1, 8)
    sway = 0.06 * np.sin(np.pi * t)
    front = np.stack([np.full(8, x), under * (1 - t), half - 0.08 - sway + 0.08 * t], axis=1)
    rear = np.stack([np.full(8, x), under * (1 - t), -half + 0.08 + sway - 0.12 * t], axis=1)
    return [tube(front, thick * 0.9, up=(1, 0, 0)), tube(rear, thick * 0.9, up=(1, 0, 0)), bearer, spine]


def _long_boards(width: float, depth: float, seat: float, plank: float, count: int) -> list[Part]:
    pitch = depth / count
    return [
        box((width, plank, pitch * 0.8), (0, seat - plank / 2, -depth / 2 + (i + 0.5) * pitch))
        for i in range(count)
    ]


def _garden(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A wide chair: the same backs and legs, stretched."""
    width, depth, seat = between(rng, 0.95, 1.7), between(rng, 0.45, 0.58), between(rng, 0.40, 0.47)
    leg, plank = between(rng, 0.06, 0.085), between(rng, 0.05, 0.08)
    styles = {
        "slatted": (backs.slatted_back, 4),
        "spindle": (backs.spindle_back, 3),
        "ladder": (backs.ladder_back, 2),
        "cross": (backs.cross_back, 1),
        "lattice": (backs.lattice_back, 2),
        "solid": (backs.solid_back, 2),
        "open": (backs.open_back, 1),
    }
    back = pick(rng, {name: weight for name, (_, weight) in styles.items()})
    plane = backs.BackPlane(
        width - leg,
        between(rng, 0.36, 0.56),
        seat,
        -depth / 2 + leg / 2,
        between(rng, 4, 14),
        bow=between(rng, 0, 0.06),
    )
    parts = styles[back][0](rng, plane, leg * 0.85)
    boards = chance(rng, 0.5)
    parts += (
        _long_boards(width, depth, seat, plank, 4)
        if boards
        else [box((width, plank, depth), (0, seat - plank / 2, 0))]
    )
    foot = supports.Footprint(width, depth, seat - plank + (0.01 if boards else 0), leg)
    stand = pick(rng, {"legs": 4, "splayed": 1.5, "turned": 1, "curved": 1, "sled": 1})
    makers = {
        "legs": supports.straight_legs,
        "splayed": supports.splayed_legs,
        "turned": supports.turned_legs,
        "curved": supports.curved_legs,
        "sled": supports.sled_runners,
    }
    parts += makers[stand](rng, foot)
    bearers = [box((leg * 0.9, plank, depth), (width / 2 - leg * 0.6, seat - plank, 0))]
    parts += with_mirror(bearers) if boards else []
    arm = pick(rng, {"post-arms": 5, "no-arms": 3, "wall-arms": 1, "loop-arms": 1})
    if arm != "no-arms":
        room = ArmRoom(
            width / 2 - leg * 0.4, seat, seat + between(rng, 0.17, 0.24), -depth / 2, depth / 2, leg * 0.9
        )
        parts += {"post-arms": post_arms, "wall-arms": wall_arms, "loop-arms": loop_arms}[arm](rng, room)
    return parts, f"garden-{back}/{stand}/{arm}"


def _backless(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A top on a support, nothing else."""
    width, depth, seat = between(rng, 1.0, 1.8), between(rng, 0.32, 0.45), between(rng, 0.40, 0.48)
    leg, thick = between(rng, 0.06, 0.1), between(rng, 0.05, 0.1)
    makers: dict[str, tuple[supports.Support, float]] = {
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
    stand = pick(rng, {name: weight for name, (_, weight) in makers.items()})
    top = pick(rng, {"plank": 3, "boards": 2, "rounded": 2, "hollow": 1})
    inset = between(rng, 0.0, 0.25) if stand in ("panels", "trestles") else between(rng, 0, 0.08)
    foot = supports.Footprint(width * (1 - inset), depth * 0.92, seat - thick, leg)
    parts = _bench_top(rng, top, width, depth, seat, thick)
    return parts + makers[stand][0](rng, foot), f"backless-{top}/{stand}/no-arms"


def _bench_top(
    rng: np.random.Generator, kind: str, width: float, depth: float, seat: float, thick: float
) -> list[Part]:
    if kind == "plank":
        return [box((width, thick, depth), (0, seat - thick / 2, 0))]
    if kind == "boards":
        bearer = box((0.07, thick, depth), (width * 0.4, seat - thick, 0))
        return _long_boards(width, depth, seat, thick * 0.8, whole(rng, 2, 4)) + with_mirror([bearer])
    if kind == "rounded":
        plan = outline(width, depth, exponent=between(rng, 2.2, 6.0), sides=40)
        return [slab(plan, seat - thick, seat, edge=thick * between(rng, 0.1, 0.45))]
    u = np.linspace(-1, 1, 15)
    dip = between(rng, 0.02, 0.07) * (1 - u**2)
    z = np.linspace(depth / 2, -depth / 2, 5)
    grid = np.stack(
        np.broadcast_arrays(u[:, None] * width / 2, (seat - thick / 2 - dip)[:, None], z[None, :]), axis=-1
    )
    return [panel(grid, thick)]


def _stone(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A thick slab on blocks; sometimes with a thick back."""
    width, depth, seat = between(rng, 1.0, 1.8), between(rng, 0.38, 0.55), between(rng, 0.40, 0.5)
    thick = between(rng, 0.09, 0.17)
    edge = between(rng, 0.0, 0.04)
    curve = between(rng, 0.0, 0.3) if chance(rng, 0.35) else 0.0
    u = np.linspace(-1, 1, 17)
    z = np.linspace(depth / 2, -depth / 2, 4)[None, :] + curve * (u**2)[:, None]
    x = np.broadcast_to(u[:, None] * width / 2, z.shape)
    top = panel(np.stack([x, np.full(z.shape, seat - thick / 2), z], axis=-1), thick)
    blocks = pick(rng, {"two": 3, "one": 1, "scroll": 1})
    under = seat - thick + 0.01
    if blocks == "one":
        legs = [box((width * between(rng, 0.5, 0.9), under, depth * 0.7), (0, under / 2, curve * 0.2))]
    else:
        place = width / 2 * between(rng, 0.6, 0.85)
        plan = outline(between(rng, 0.14, 0.26), depth * 0.85, exponent=8.0 if blocks == "two" else 3.0)
        legs = with_mirror(
            [slab(plan, 0, under, edge=edge, centre=(place, curve * (2 * place / width) ** 2))]
        )
    back = "no-back"
    if curve == 0 and chance(rng, 0.3):
        back = "wall"
        tall = between(rng, 0.3, 0.45)
        legs.append(
            box((width, tall + thick, thick * 0.9), (0, seat + (tall - thick) / 2, -depth / 2 + thick * 0.45))
        )
    return [top, *legs], f"stone-{back}/{blocks}-blocks/no-arms"


def _pew(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Church pew: shaped boards at both ends, solid seat and back."""
    width, depth, seat = between(rng, 1.2, 2.0), between(rng, 0.45, 0.58), between(rng, 0.42, 0.48)
    tall, tilt, board = between(rng, 0.42, 0.56), between(rng, 4, 14), between(rng, 0.045, 0.07)
    plane = backs.BackPlane(width - board, tall, seat, -depth / 2 + 0.05, tilt)
    parts = [
        panel(
            plane.grid(np.linspace(-1, 1, 5), -0.95 * seat / tall if chance(rng, 0.4) else -0.1, 1.0, rows=4),
            board,
        )
    ]
    parts.append(box((width - board, board, depth - 0.05), (0, seat - board / 2, 0.02)))
    if chance(rng, 0.5):
        parts.append(box((width - board, seat, board), (0, seat / 2, between(rng, -0.2, 0.12) * depth)))
    arm = seat + between(rng, 0.1, 0.24)
    s = np.linspace(0, 1, 13)
    lean = np.tan(np.radians(tilt)) * tall
    rear = np.full(13, -depth / 2 - lean)
    top = arm + (seat + tall + 0.03 - arm) * np.clip(1 - s * between(rng, 1.8, 3.0), 0, 1) ** between(
        rng, 0.6, 1.6
    )
    z = rear + (depth + lean) * s
    y = top[:, None] * np.linspace(0, 1, 4)
    grid = np.stack([np.full(y.shape, width / 2), y, np.broadcast_to(z[:, None], y.shape)], axis=-1)
    parts += with_mirror([panel(grid[::-1], board)])
    return parts, "pew/end-boards/wall-arms"


def _padded(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Upholstered bench, perhaps with scrolled ends."""
    width, depth, seat = between(rng, 0.95, 1.5), between(rng, 0.38, 0.5), between(rng, 0.42, 0.5)
    pad, leg = between(rng, 0.1, 0.16), between(rng, 0.055, 0.085)
    parts = [
        rounded_box((width, pad, depth), (0, seat - pad / 2, 0), 0.045, bulge=(0, 0.02, 0)),
        box((width * 0.97, 0.06, depth * 0.95), (0, seat - pad - 0.02, 0)),
    ]
    ends = "no-arms"
    if chance(rng, 0.5):
        ends = "scrolls"
        t = np.linspace(0, 1, 8)
        x = width / 2 - 0.05 + between(rng, 0.05, 0.12) * t**2
        y = seat - 0.08 + between(rng, 0.22, 0.32) * t
        z = np.linspace(depth / 2, -depth / 2, 4)
        grid = np.stack(np.broadcast_arrays(x[None, :], y[None, :], z[:, None]), axis=-1)
        parts += with_mirror([panel(grid, 0.08)])
    foot = supports.Footprint(width * 0.95, depth * 0.92, seat - pad - 0.04, leg)
    makers = {
        "legs": supports.straight_legs,
        "turned": supports.turned_legs,
        "curved": supports.curved_legs,
        "splayed": supports.splayed_legs,
    }
    stand = pick(rng, dict.fromkeys(makers, 1.0))
    return parts + makers[stand](rng, foot), f"padded/{stand}/{ends}"


def _storage(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Hall bench: a chest with a lid, a back and arms."""
    width, depth, seat = between(rng, 0.95, 1.4), between(rng, 0.42, 0.52), between(rng, 0.42, 0.48)
    board, feet = between(rng, 0.045, 0.065), between(rng, 0.0, 0.09)
    parts = [
        box((width - 0.05, seat - feet - board + 0.01, depth - 0.04), (0, (seat - board + feet) / 2, 0)),
        box((width, board, depth), (0, seat - board / 2, 0.01)),
    ]
    plane = backs.BackPlane(
        width - board, between(rng, 0.38, 0.6), seat, -depth / 2 + 0.03, between(rng, 0, 6)
    )
    style = pick(rng, {"solid": 2, "slatted": 1, "caned": 1})
    parts += {"solid": backs.solid_back, "slatted": backs.slatted_back, "caned": backs.caned_back}[style](
        rng, plane, board
    )
    if feet > 0.03:
        parts += supports.plain_legs(rng, supports.Footprint(width - 0.05, depth - 0.04, feet, 0.09))
    arm = pick(rng, {"post-arms": 1, "wall-arms": 1, "no-arms": 1})
    if arm != "no-arms":
        room = ArmRoom(
            width / 2 - board / 2, seat, seat + between(rng, 0.17, 0.24), -depth / 2 + 0.02, depth / 2, board
        )
        parts += (post_arms if arm == "post-arms" else wall_arms)(rng, room)
    return parts, f"storage-{style}/{'feet' if feet > 0.03 else 'plinth'}/{arm}"
