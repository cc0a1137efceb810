"""Chairs built as a whole: moulded shells, upholstered, round, planked and reclined chairs."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from tetgan.shapes.builtin import arms, backs, supports
from tetgan.shapes.builtin import upholstery as soft
from tetgan.shapes.builtin.draws import between, chance, pick, pick_from, whole
from tetgan.shapes.builtin.parts import Part, bar, box, outline, panel, rounded_box, sheet, slab, with_mirror
from tetgan.shapes.builtin.upholstery import Settee

# --- shell --------------------------------------------------------------------------------------------------

_SHELL_SUPPORTS: dict[str, tuple[supports.Support, float]] = {
    "splayed-legs": (supports.splayed_legs, 4),
    "disc-pedestal": (supports.disc_pedestal, 3),
    "star-pedestal": (supports.star_pedestal, 2),
    "straight-legs": (supports.straight_legs, 2),
    "sled": (supports.sled_runners, 2),
    "hairpin-legs": (supports.hairpin_legs, 1),
}


@dataclass(frozen=True)
class ShellSizes:
    """Metres; `bend` is where, from 0 at the front edge to 1 at the top, seat turns into back.

    `cup` hollows the shell across, `wings` raise its sides, `narrowing` and `crown` are the shares of
    its width and of the height of its back that the top loses towards the corners.
    """

    width: float
    depth: float
    seat: float
    back: float
    lean: float
    cup: float
    wings: float
    narrowing: float
    crown: float
    bend: float


def shell_chair(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Seat and back in one moulded piece, thick or an open sheet."""
    width, winged = between(rng, 0.42, 0.62), chance(rng, 0.5)
    sizes = ShellSizes(
        width=width,
        depth=width * between(rng, 0.85, 1.1),
        seat=between(rng, 0.40, 0.50),
        back=between(rng, 0.34, 0.60),
        lean=between(rng, 0.05, 0.22),
        cup=between(rng, 0.0, 0.09),
        wings=between(rng, 0.06, 0.24) if winged else 0.0,
        narrowing=between(rng, -0.1, 0.35),
        crown=0.0 if winged or chance(rng, 0.3) else between(rng, 0.1, 0.5),
        bend=between(rng, 0.36, 0.56),
    )
    grid = _shell_surface(sizes)
    shell = sheet(grid) if chance(rng, 0.3) else panel(grid, between(rng, 0.022, 0.045))
    support, make_support = pick_from(rng, _SHELL_SUPPORTS)
    foot = supports.Footprint(width * 0.78, sizes.depth * 0.66, sizes.seat - 0.02, between(rng, 0.035, 0.06))
    plate = box((foot.width, 0.03, foot.depth), (0, sizes.seat - 0.015, 0))
    parts = [shell, plate, *make_support(rng, foot)]
    if chance(rng, 0.3):
        thick = between(rng, 0.05, 0.1)
        cushion = (width * 0.84, thick, sizes.depth * 0.8)
        parts.append(
            rounded_box(cushion, (0, sizes.seat + thick / 2, 0.02), thick * 0.4, bulge=(0, 0.015, 0))
        )
    return parts, f"shell/{support}/{'wings' if winged else 'no-arms'}"


def _shell_surface(sizes: ShellSizes) -> Float[np.ndarray, "N M 3"]:
    """Rows across the chair, from one side to the other; each runs from the front edge to the top."""
    u, s = np.linspace(1, -1, 15)[:, None], np.linspace(0, 1, 17)
    rise = np.clip((s - sizes.bend) / (1 - sizes.bend), 0, 1)
    near_bend = np.exp(-(((s - sizes.bend) / 0.1) ** 2))
    wings = sizes.wings * np.exp(-(((s - sizes.bend) / 0.22) ** 2)) * np.abs(u) ** 3
    x = u * sizes.width / 2 * (1 - sizes.narrowing * rise**2)
    y = (
        sizes.seat
        + sizes.back * rise * (1 - sizes.crown * np.abs(u) ** 3)
        + 0.035 * near_bend
        - 0.03 * np.exp(-((s / 0.08) ** 2))
    )
    z = sizes.depth * (0.5 - np.clip(s / sizes.bend, 0, 1)) - sizes.lean * rise
    y = y + sizes.cup * u**2 * (1 - rise) + wings
    z = z + 1.5 * sizes.cup * u**2 * rise + 0.3 * wings
    return np.stack([x, y, z], axis=-1)


# --- upholstered --------------------------------------------------------------------------------------------


def club_chair(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Thick arms and cushions on a box; sometimes winged."""
    settee = _club_sizes(rng)
    arm = pick(rng, {"block-arms": 3, "rolled-arms": 2, "sloped-arms": 2})
    make_arms = {
        "block-arms": soft.block_arms,
        "rolled-arms": soft.rolled_arms,
        "sloped-arms": soft.sloped_arms,
    }[arm]
    parts = [soft.seat_base(settee), *soft.seat_cushions(settee, 1), *make_arms(rng, settee)]
    back = pick(rng, {"plain": 2, "cushion": 3, "tufted": 1, "shaped": 1})
    if back == "tufted":
        parts += soft.tufted_back(rng, settee)
    elif back == "shaped":
        parts.append(soft.shaped_back(rng, settee))
    else:
        parts.append(soft.plain_back(settee, over_arms=chance(rng, 0.5)))
        parts += soft.back_cushions(rng, settee, 1) if back == "cushion" else []
    winged = arm != "sloped-arms" and settee.back_top > settee.arm_top + 0.3 and chance(rng, 0.6)
    parts += soft.wings(settee) if winged else []
    feet, kind = _club_feet(rng, settee)
    return parts + feet, f"{'wing' if winged else 'club'}-{back}/{kind}/{arm}"


def _club_sizes(rng: np.random.Generator) -> Settee:
    seat = between(rng, 0.38, 0.46)
    return Settee(
        width=between(rng, 0.66, 0.92),
        depth=between(rng, 0.68, 0.88),
        floor=between(rng, 0.03, 0.2),
        seat=seat,
        arm=between(rng, 0.09, 0.17),
        arm_top=seat + between(rng, 0.12, 0.24),
        back_top=seat + between(rng, 0.36, 0.64),
        thick=between(rng, 0.13, 0.2),
        soft=between(rng, 0.015, 0.06),
        tilt=between(rng, 2.0, 12.0),
    )


def _club_feet(rng: np.random.Generator, settee: Settee) -> tuple[list[Part], str]:
    if settee.floor < 0.06:
        return [soft.skirt(settee)], "skirt"
    foot = supports.Footprint(
        settee.width * 0.94, settee.depth * 0.9, settee.floor, between(rng, 0.045, 0.07)
    )
    if settee.floor > 0.12 and chance(rng, 0.4):
        return supports.sled_runners(rng, foot), "sled"
    return supports.plain_legs(rng, foot), "block-feet"


def tub_chair(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Round chair whose back wraps into the arms."""
    radius, seat, base = between(rng, 0.32, 0.42), between(rng, 0.38, 0.46), between(rng, 0.05, 0.22)
    plan = outline(2 * radius, 2 * radius, exponent=2.4)
    parts = [
        _wrapped_wall(rng, radius, base),
        slab(plan * 0.98, base, seat - 0.08, edge=0.01),
        slab(plan * 0.93, seat - 0.1, seat, edge=0.04),
    ]
    makers = {
        "splayed-legs": supports.splayed_legs,
        "disc-pedestal": supports.disc_pedestal,
        "drum": supports.drum,
    }
    support = pick(rng, {"splayed-legs": 3, "disc-pedestal": 1.5, "drum": 1.5})
    foot = supports.Footprint(radius * 1.5, radius * 1.5, base, 0.055)
    return parts + makers[support](rng, foot), f"tub/{support}/wrapped"


def _wrapped_wall(rng: np.random.Generator, radius: float, base: float) -> Part:
    """Wall about the seat, highest behind."""
    sweep = np.radians(between(rng, 105.0, 140.0))
    high, low = between(rng, 0.66, 0.95), between(rng, 0.50, 0.66)
    angle, s = np.linspace(-sweep, sweep, 25)[:, None], np.linspace(0, 1, 6)
    top = low + (high - low) * (0.5 + 0.5 * np.cos(angle / sweep * np.pi)) ** between(rng, 0.5, 1.5)
    spread = radius * (1 + between(rng, 0.0, 0.22) * s)
    grid = np.stack([-np.sin(angle) * spread, base + (top - base) * s, -np.cos(angle) * spread], axis=-1)
    return panel(grid, between(rng, 0.05, 0.11))


# --- wooden -------------------------------------------------------------------------------------------------


def plank_chair(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Garden chair: a reclined fan of boards, a sloping seat, wide flat arms."""
    width, depth = between(rng, 0.52, 0.68), between(rng, 0.52, 0.7)
    front, slope = between(rng, 0.34, 0.44), between(rng, 0.04, 0.14)
    boards, thick = whole(rng, 3, 7), between(rng, 0.028, 0.045)
    plane = backs.BackPlane(
        width=width * between(rng, 0.75, 0.92),
        height=between(rng, 0.58, 0.82),
        seat=front - slope,
        z=-depth / 2,
        tilt=between(rng, 12.0, 28.0),
        flare=between(rng, 0.9, 1.3),
    )
    parts = [
        *_fan(plane, boards, thick, crown=between(rng, 0.0, 0.25)),
        *_treads(width, depth, front, slope, boards),
    ]
    arm, x, leg = front + between(rng, 0.16, 0.26), width / 2 + 0.02, between(rng, 0.045, 0.065)
    rear = front - slope - 0.06
    side = [
        box((between(rng, 0.09, 0.15), thick, depth * 1.1), (x + 0.02, arm, 0.0)),
        box((leg, arm, leg * 2), (x, arm / 2, depth / 2 - leg)),
        box((leg, arm, leg * 1.5), (x, arm / 2, -depth / 2 + leg * 0.4)),
        bar(
            (x - leg / 2, front - 0.03, depth / 2),
            (x - leg / 2, rear, -depth / 2 - 0.04),
            (0.04, 0.09),
            square=True,
        ),
    ]
    brace = plane.point(0, between(rng, 0.45, 0.7)) - (0, 0, 0.03)
    return [
        *parts,
        *with_mirror(side),
        box((2 * x, 0.06, 0.04), brace),
    ], f"planks-{boards}/board-legs/flat-arms"


def _fan(plane: backs.BackPlane, count: int, thick: float, *, crown: float) -> list[Part]:
    """Upright boards, the outer ones lower."""
    across = np.linspace(0.03, 2 / count - 0.03, 3)
    places = np.linspace(-1, 1, count + 1)[:-1, None] + across
    return [panel(plane.grid(u, -0.12, 1 - crown * u**2, rows=4), thick) for u in places]


def _treads(width: float, depth: float, front: float, slope: float, count: int) -> list[Part]:
    """Boards of a seat that falls by `slope` to the rear."""
    angle = -np.degrees(np.arctan2(slope, depth))
    middles = [(0.0, front - slope * (1 - s), (s - 0.5) * depth) for s in np.linspace(0.06, 0.94, count)]
    size = (width * 0.9, 0.035, depth / count * 0.84)
    return [box(size, middle).rotated("x", angle, middle) for middle in middles]


def reclined_chair(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Two long cushions, sloping and leaning, on a wooden frame."""
    width, depth, seat = between(rng, 0.52, 0.66), between(rng, 0.55, 0.7), between(rng, 0.36, 0.44)
    thick, tall, leg = between(rng, 0.09, 0.15), between(rng, 0.5, 0.72), between(rng, 0.045, 0.07)
    slope, lean = between(rng, 4.0, 11.0), between(rng, 14.0, 26.0)
    knee = (0.0, seat, depth / 2)
    cushion = rounded_box((width, thick, depth), (0, seat - thick / 2, 0), 0.04, bulge=(0, 0.015, 0))
    back = rounded_box(
        (width, tall, thick), (0, seat + tall / 2 - 0.05, -depth / 2), 0.04, bulge=(0, 0, 0.02)
    )
    back = back.rotated("x", -lean, (0, seat, -depth / 2))
    parts = [part.rotated("x", -slope, knee) for part in (cushion, back)]
    makers = {
        "splayed-legs": supports.splayed_legs,
        "sled": supports.sled_runners,
        "crossed-legs": supports.crossed_legs,
        "rockers": supports.rockers,
    }
    support = pick(rng, {"splayed-legs": 2, "sled": 1, "crossed-legs": 1, "rockers": 1})
    parts += makers[support](rng, supports.Footprint(width, depth, seat - thick * 0.8, leg))
    if chance(rng, 0.4):
        return parts, f"reclined/{support}/no-arms"
    room = arms.ArmRoom(
        width / 2 - 0.01, seat - 0.05, seat + between(rng, 0.14, 0.22), -depth / 2 - 0.05, depth / 2, leg
    )
    return parts + arms.post_arms(rng, room), f"reclined/{support}/post-arms"
