"""Chairs: composed of seat, support, back and arms; or one of a few kinds built as a whole."""

from dataclasses import dataclass

import numpy as np

from tetgan.shapes.builtin import arms, backs, supports
from tetgan.shapes.builtin.draws import between, chance, pick, whole
from tetgan.shapes.builtin.parts import Part, bar, box, outline, panel, rounded_box, sheet, slab, with_mirror

BACKS: dict[str, tuple[backs.Back, float]] = {
    "solid": (backs.solid_back, 3),
    "padded": (backs.padded_back, 3),
    "slatted": (backs.slatted_back, 3),
    "spindle": (backs.spindle_back, 2.5),
    "ladder": (backs.ladder_back, 3),
    "open": (backs.open_back, 1.5),
    "cross": (backs.cross_back, 1.5),
    "splat": (backs.splat_back, 2),
    "hoop": (backs.hoop_back, 1.5),
    "medallion": (backs.medallion_back, 1.5),
    "lattice": (backs.lattice_back, 1),
    "caned": (backs.caned_back, 1.5),
    "floating": (backs.floating_back, 2),
}

SUPPORTS: dict[str, tuple[supports.Support, float]] = {
    "straight-legs": (supports.straight_legs, 7),
    "splayed-legs": (supports.splayed_legs, 4),
    "turned-legs": (supports.turned_legs, 2),
    "curved-legs": (supports.curved_legs, 2.5),
    "star-pedestal": (supports.star_pedestal, 3),
    "disc-pedestal": (supports.disc_pedestal, 1.5),
    "sled": (supports.sled_runners, 2),
    "rockers": (supports.rockers, 1),
    "cantilever": (supports.cantilever, 2),
    "side-panels": (supports.side_panels, 1),
    "plinth": (supports.plinth, 0.7),
    "crossed-legs": (supports.crossed_legs, 1),
}

ARMS = {
    "post-arms": arms.post_arms,
    "loop-arms": arms.loop_arms,
    "pad-arms": arms.pad_arms,
    "wall-arms": arms.wall_arms,
}


@dataclass(frozen=True)
class Frame:
    """Main sizes of a chair in metres; `seat` is the height of the seat's top."""

    width: float
    depth: float
    seat: float
    cushion: float
    back: float
    leg: float


def make_chair(rng: np.random.Generator) -> tuple[list[Part], str]:
    """One chair and its structural kind."""
    family = pick(rng, {_composed: 70, _shell: 9, _club: 9, _tub: 4, _plank: 3, _lounger: 2, _stool: 3})
    return family(rng)


def _frame(rng: np.random.Generator) -> Frame:
    width = between(rng, 0.40, 0.60)
    return Frame(
        width=width,
        depth=width * between(rng, 0.85, 1.12),
        seat=between(rng, 0.40, 0.52),
        cushion=between(rng, 0.04, 0.10),
        back=between(rng, 0.36, 0.66),
        leg=between(rng, 0.042, 0.075),
    )


def _composed(rng: np.random.Generator) -> tuple[list[Part], str]:
    frame = _frame(rng)
    support = pick(rng, {name: weight for name, (_, weight) in SUPPORTS.items()})
    back = pick(rng, {name: weight for name, (_, weight) in BACKS.items()})
    if support == "star-pedestal" and chance(rng, 0.7):
        back = pick(rng, {"padded": 3, "solid": 1, "floating": 1})
    arm = _pick_arms(rng, support)
    parts = [*_seat(rng, frame), *_support(rng, frame, support), *_back(rng, frame, back)]
    if arm != "no-arms":
        parts += ARMS[arm](rng, _arm_room(rng, frame))
    return parts, f"{back}/{support}/{arm}"


def _pick_arms(rng: np.random.Generator, support: str) -> str:
    if support == "star-pedestal":
        return pick(rng, {"no-arms": 3, "pad-arms": 6, "loop-arms": 2})
    return pick(rng, {"no-arms": 11, "post-arms": 4, "loop-arms": 2, "wall-arms": 1})


def _support(rng: np.random.Generator, frame: Frame, kind: str) -> list[Part]:
    foot = supports.Footprint(frame.width, frame.depth, frame.seat - frame.cushion, frame.leg)
    return SUPPORTS[kind][0](rng, foot)


def _back(rng: np.random.Generator, frame: Frame, kind: str) -> list[Part]:
    plane = backs.BackPlane(
        width=(frame.width - frame.leg) * between(rng, 0.88, 1.0),
        height=frame.back,
        seat=frame.seat,
        z=-frame.depth / 2 + frame.leg * 0.5,
        tilt=between(rng, 2, 14),
        sway=between(rng, -0.02, 0.06),
        bow=pick(rng, {0.0: 1, between(rng, 0.02, 0.09): 2}),
        flare=between(rng, 0.85, 1.15),
    )
    return BACKS[kind][0](rng, plane, frame.leg * between(rng, 0.7, 1.0))


def _arm_room(rng: np.random.Generator, frame: Frame) -> arms.ArmRoom:
    return arms.ArmRoom(
        x=frame.width / 2 - frame.leg * between(rng, 0.1, 0.5),
        seat=frame.seat,
        height=frame.seat + min(between(rng, 0.17, 0.26), frame.back * 0.7),
        back=-frame.depth / 2 - 0.02,
        front=frame.depth / 2,
        thickness=frame.leg * between(rng, 0.75, 1.0),
    )


def _seat(rng: np.random.Generator, frame: Frame) -> list[Part]:
    """Board, rounded plate, cushion on a frame, or a hollowed panel."""
    kind = pick(rng, {"board": 3, "rounded": 3, "cushion": 3, "saddle": 1.5, "slats": 1})
    size, y = (frame.width, frame.cushion, frame.depth), frame.seat - frame.cushion / 2
    if kind == "board":
        return [box(size, (0, y, 0))]
    if kind == "rounded":
        plan = outline(
            frame.width, frame.depth, exponent=between(rng, 2.6, 8.0), taper=between(rng, 0.75, 1.0)
        )
        return [
            slab(plan, frame.seat - frame.cushion, frame.seat, edge=frame.cushion * between(rng, 0.1, 0.45))
        ]
    if kind == "cushion":
        puff = frame.cushion * between(rng, 0.8, 1.6)
        board = box((frame.width, frame.cushion, frame.depth), (0, y - 0.01, 0))
        pad = rounded_box(
            (frame.width * 0.97, puff, frame.depth * 0.97),
            (0, frame.seat + puff / 4, 0),
            puff * 0.4,
            bulge=(0, 0.015, 0),
        )
        return [board, pad]
    if kind == "slats":
        return _slatted_seat(rng, frame)
    u, v = np.meshgrid(np.linspace(-1, 1, 11), np.linspace(-1, 1, 11), indexing="ij")
    dip = between(rng, 0.02, 0.05) * (1 - u**2) * (1 - (v * 0.8 - 0.1) ** 2)
    grid = np.stack([u * frame.width / 2, frame.seat - 0.02 - dip, -v * frame.depth / 2], axis=-1)
    return [panel(grid, frame.cushion * 0.8)]


def _slatted_seat(rng: np.random.Generator, frame: Frame) -> list[Part]:
    """Boards from side to side on two bearers."""
    count = whole(rng, 4, 6)
    pitch, thick = frame.depth / count, frame.cushion * 0.6
    parts = [
        box(
            (frame.width, thick, pitch * 0.75),
            (0, frame.seat - thick / 2, -frame.depth / 2 + (i + 0.5) * pitch),
        )
        for i in range(count)
    ]
    bearer = box(
        (frame.leg, frame.cushion, frame.depth),
        (frame.width / 2 - frame.leg / 2, frame.seat - frame.cushion / 2 - 0.005, 0),
    )
    return parts + with_mirror([bearer])


def _shell(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Moulded seat and back in one curved piece, thick or an open sheet."""
    frame = _frame(rng)
    support = pick(
        rng,
        {
            "splayed-legs": 4,
            "star-pedestal": 2,
            "disc-pedestal": 3,
            "sled": 2,
            "straight-legs": 2,
            "hairpin-legs": 1,
        },
    )
    s = np.linspace(0, 1, 17)
    u = np.linspace(-1, 1, 15)
    bend = between(rng, 0.40, 0.52)
    height, depth = frame.back, frame.depth
    lean = between(rng, 0.08, 0.2)
    seat_z = depth / 2 - depth * np.clip(s / bend, 0, 1)
    rise = np.clip((s - bend) / (1 - bend), 0, 1)
    blend = between(rng, 0.02, 0.05)
    y = (
        frame.seat
        + height * rise
        + blend * np.exp(-(((s - bend) / 0.1) ** 2))
        - 0.03 * np.exp(-((s / 0.08) ** 2))
    )
    z = seat_z - lean * rise
    side = between(rng, 0.0, 0.22) if chance(rng, 0.6) else 0.0
    wings = side * np.exp(-(((s - bend) / 0.22) ** 2))
    cup = between(rng, 0.03, 0.08)
    half = frame.width / 2 * (1 - between(rng, 0.05, 0.3) * rise**2)
    edge = np.abs(u)[:, None] ** 3
    grid = np.stack(
        [
            u[:, None] * half * (1 - 0.06 * (wings > 0.05)),
            y + cup * u[:, None] ** 2 * (1 - rise) + wings * edge,
            z + cup * 1.5 * u[:, None] ** 2 * rise + 0.3 * wings * edge,
        ],
        axis=-1,
    )
    open_sheet = chance(rng, 0.12)
    shell = sheet(grid[::-1]) if open_sheet else panel(grid[::-1], between(rng, 0.02, 0.045))
    foot = supports.Footprint(frame.width * 0.8, frame.depth * 0.8, frame.seat - 0.02, frame.leg * 0.8)
    base = {**SUPPORTS, "hairpin-legs": (supports.hairpin_legs, 1)}[support][0](rng, foot)
    plate = box((foot.width, 0.03, foot.depth), (0, frame.seat - 0.015, 0))
    return [shell, plate, *base], f"shell/{support}/{'wings' if side else 'no-arms'}"


def _club(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Upholstered armchair: box, thick arms, cushions; sometimes winged."""
    width, depth = between(rng, 0.70, 0.90), between(rng, 0.70, 0.88)
    seat, arm, back = between(rng, 0.38, 0.46), between(rng, 0.10, 0.18), between(rng, 0.75, 1.05)
    arm_top = seat + between(rng, 0.12, 0.24)
    base = between(rng, 0.03, 0.16)
    soft = between(rng, 0.015, 0.06)
    inner, thick = width - 2 * arm, between(rng, 0.14, 0.22)
    front = depth / 2
    parts = [
        rounded_box((width, seat - 0.14 - base, depth * 0.97), (0, (seat - 0.14 + base) / 2, 0), 0.02),
        rounded_box(
            (inner + 0.01, 0.17, depth - thick),
            (0, seat - 0.07, thick / 2 + 0.005),
            0.04,
            bulge=(0, 0.025, 0.01),
        ),
        *with_mirror([_arm_block(rng, arm, base, arm_top, depth, width, soft)]),
    ]
    tilt = between(rng, 2, 12)
    tall = back - base
    block = rounded_box(
        (width - (arm if chance(rng, 0.5) else 0), tall, thick),
        (0, base + tall / 2, -front + thick / 2),
        soft,
    )
    parts.append(block.rotated("x", -tilt, (0, base, -front)))
    if chance(rng, 0.6):
        pad = rounded_box(
            (inner, back - seat, 0.14),
            (0, (back + seat) / 2 - 0.02, -front + thick + 0.04),
            0.05,
            bulge=(0, 0, 0.03),
        )
        parts.append(pad.rotated("x", -tilt, (0, base, -front)))
    winged = back > 0.85 and chance(rng, 0.7)
    if winged:
        wing = rounded_box(
            (0.08, back - arm_top, depth * 0.35),
            (width / 2 - arm / 2 - 0.02, (back + arm_top) / 2, -front + depth * 0.2),
            0.03,
        )
        parts += with_mirror([wing.rotated("x", -tilt, (0, base, -front))])
    foot = supports.Footprint(width * 0.94, depth * 0.92, base, between(rng, 0.045, 0.07))
    parts += (
        supports.straight_legs(rng, foot)
        if base > 0.06
        else [box((width * 0.9, base + 0.02, depth * 0.9), (0, base / 2 + 0.01, 0))]
    )
    return parts, f"{'wing' if winged else 'club'}/{'block-feet' if base > 0.06 else 'plinth'}/thick-arms"


def _arm_block(
    rng: np.random.Generator, thick: float, low: float, high: float, depth: float, width: float, soft: float
) -> Part:
    """Upholstered side, a block or a rolled top."""
    x = width / 2 - thick / 2
    return rounded_box(
        (thick, high - low, depth * between(rng, 0.86, 1.0)),
        (x, (high + low) / 2, 0),
        soft,
        bulge=(0.01, 0.01, 0),
    )


def _tub(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Round chair whose back wraps into the arms."""
    radius, seat = between(rng, 0.32, 0.42), between(rng, 0.38, 0.46)
    back, front_top = between(rng, 0.68, 0.88), between(rng, 0.50, 0.66)
    base = between(rng, 0.05, 0.2)
    angle = np.radians(np.linspace(-between(rng, 110, 135), between(rng, 110, 135), 23))
    s = np.linspace(0, 1, 6)
    top = front_top + (back - front_top) * (0.5 + 0.5 * np.cos(np.clip(angle * 1.2, -np.pi, np.pi)))
    y = base + (top[:, None] - base) * s
    flare = 1 + between(rng, 0.0, 0.18) * s
    grid = np.stack(
        [-radius * np.sin(angle)[:, None] * flare, y, -radius * np.cos(angle)[:, None] * flare], axis=-1
    )
    parts = [panel(grid, between(rng, 0.06, 0.11))]
    plan = outline(2 * radius, 2 * radius, exponent=2.4)
    parts += [slab(plan * 0.98, base, seat - 0.08, edge=0.01), slab(plan * 0.93, seat - 0.1, seat, edge=0.04)]
    support = pick(rng, {"splayed-legs": 2, "disc-pedestal": 1.5, "plinth": 1})
    foot = supports.Footprint(radius * 1.5, radius * 1.5, base, 0.055)
    parts += SUPPORTS[support][0](rng, foot)
    return parts, f"tub/{support}/wrapped"


def _plank(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Garden chair of planks: reclined fan of boards, wide flat arms."""
    width, depth = between(rng, 0.55, 0.68), between(rng, 0.55, 0.7)
    front, slope = between(rng, 0.34, 0.42), between(rng, 0.05, 0.14)
    board, thick = whole(rng, 4, 6), between(rng, 0.025, 0.04)
    back = backs.BackPlane(
        width * 0.8,
        between(rng, 0.65, 0.8),
        front - slope,
        -depth / 2,
        between(rng, 16, 26),
        flare=between(rng, 1.0, 1.3),
    )
    parts = []
    crown = between(rng, 0.0, 0.2)
    for left in np.linspace(-1, 1, board + 1)[:-1]:
        u = left + np.linspace(0.03, 2 / board - 0.03, 3)
        parts.append(panel(back.grid(u, -0.12, 1 - crown * u**2, rows=4), thick))
    for s in np.linspace(0.06, 0.94, board):
        tread = box(
            (width * 0.9, thick, depth / board * 0.82), (0, front - slope * (1 - s), -depth / 2 + s * depth)
        )
        parts.append(
            tread.rotated(
                "x",
                -np.degrees(np.arctan2(slope, depth)),
                (0, front - slope * (1 - s), -depth / 2 + s * depth),
            )
        )
    arm = front + between(rng, 0.18, 0.26)
    x, leg = width / 2 + 0.02, between(rng, 0.04, 0.06)
    side = [
        box((0.12, thick, depth * 1.1), (x + 0.02, arm, 0.0)),
        box((leg, arm, leg * 2), (x, arm / 2, depth / 2 - leg)),
        box((leg, arm, leg * 1.5), (x, arm / 2, -depth / 2 + leg * 0.4)),
        bar(
            (x - leg / 2, front - 0.03, depth / 2),
            (x - leg / 2, front - slope - 0.06, -depth / 2 - 0.04),
            (0.04, 0.09),
            square=True,
            up=(0, 1, 0),
        ),
    ]
    parts += with_mirror(side)
    parts.append(
        box(
            (2 * x, 0.05, 0.035),
            (
                0,
                back.seat + back.height * 0.55,
                -depth / 2 - np.tan(np.radians(back.tilt)) * back.height * 0.55 - 0.03,
            ),
        )
    )
    return parts, "planks/board-legs/flat-arms"


def _lounger(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Easy chair with a long seat and back in one reclined cushion on a frame."""
    frame = Frame(
        between(rng, 0.52, 0.66),
        between(rng, 0.55, 0.68),
        between(rng, 0.34, 0.42),
        between(rng, 0.09, 0.14),
        between(rng, 0.5, 0.65),
        between(rng, 0.045, 0.065),
    )
    slope = between(rng, 6, 12)
    seat = rounded_box(
        (frame.width, frame.cushion, frame.depth),
        (0, frame.seat - frame.cushion / 2, 0),
        0.04,
        bulge=(0, 0.015, 0),
    )
    back = rounded_box(
        (frame.width, frame.back, frame.cushion),
        (0, frame.seat + frame.back / 2 - 0.04, -frame.depth / 2),
        0.04,
        bulge=(0, 0, 0.02),
    )
    pivot = (0, frame.seat, -frame.depth / 2)
    parts = [seat.rotated("x", -slope, pivot), back.rotated("x", -between(rng, 18, 30), pivot)]
    support = pick(rng, {"sled": 1, "crossed-legs": 1, "splayed-legs": 2, "rockers": 1})
    foot = supports.Footprint(frame.width, frame.depth, frame.seat - frame.cushion * 0.7, frame.leg)
    parts += SUPPORTS[support][0](rng, foot)
    arm = "post-arms" if chance(rng, 0.6) else "no-arms"
    if arm == "post-arms":
        parts += arms.post_arms(rng, _arm_room(rng, frame))
    return parts, f"easy/{support}/{arm}"


def _stool(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Bar chair: a high seat with a low back and a foot rest."""
    width = between(rng, 0.36, 0.44)
    frame = Frame(
        width,
        width,
        between(rng, 0.62, 0.76),
        between(rng, 0.04, 0.09),
        between(rng, 0.22, 0.36),
        between(rng, 0.04, 0.055),
    )
    back = pick(rng, {"solid": 2, "open": 1, "slatted": 1, "ladder": 1, "padded": 1})
    support = pick(rng, {"splayed-legs": 3, "straight-legs": 3, "disc-pedestal": 2})
    parts = [*_seat(rng, frame), *_support(rng, frame, support), *_back(rng, frame, back)]
    return parts, f"bar-{back}/{support}/no-arms"
