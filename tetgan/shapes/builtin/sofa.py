"""Sofas: upholstered in several manners, wooden-framed, L-shaped, curved, and day beds."""

import numpy as np
from jaxtyping import Float

from tetgan.shapes.builtin import supports
from tetgan.shapes.builtin import upholstery as soft
from tetgan.shapes.builtin.arms import ArmRoom, post_arms
from tetgan.shapes.builtin.backs import BackPlane, ladder_back, slatted_back
from tetgan.shapes.builtin.draws import between, chance, pick, pick_from, whole
from tetgan.shapes.builtin.parts import Part, Varying, box, panel, rounded_box, with_mirror
from tetgan.shapes.builtin.upholstery import Settee

ARMS = {"block-arms": soft.block_arms, "rolled-arms": soft.rolled_arms, "sloped-arms": soft.sloped_arms}


def make_sofa(rng: np.random.Generator) -> tuple[list[Part], str]:
    """One sofa and its structural kind."""
    return pick(rng, {_straight: 60, _corner: 16, _wooden: 9, _curved: 7, _daybed: 6})(rng)


def _settee(rng: np.random.Generator) -> Settee:
    seat = between(rng, 0.38, 0.46)
    back = seat + between(rng, 0.30, 0.50)
    return Settee(
        width=between(rng, 1.35, 2.35),
        depth=between(rng, 0.78, 1.0),
        floor=between(rng, 0.03, 0.17),
        seat=seat,
        arm=between(rng, 0.11, 0.26),
        arm_top=seat + between(rng, 0.12, 0.24),
        back_top=back,
        thick=between(rng, 0.14, 0.24),
        soft=between(rng, 0.015, 0.08),
        tilt=between(rng, 0.0, 9.0),
    )


def _straight(rng: np.random.Generator) -> tuple[list[Part], str]:
    settee = _settee(rng)
    seats = whole(rng, 2, 3) if settee.width > 1.6 else 2
    arm = pick(rng, {"block-arms": 5, "rolled-arms": 3, "sloped-arms": 2, "no-arms": 1.5})
    back = pick(rng, {"cushions": 4, "plain": 2, "tufted": 2, "shaped": 2})
    parts = [soft.seat_base(settee), *soft.seat_cushions(settee, seats if chance(rng, 0.8) else 1)]
    parts += _back(rng, settee, back, seats)
    parts += ARMS[arm](rng, settee) if arm in ARMS else []
    parts += soft.throw_pillows(rng, settee) if chance(rng, 0.25) else []
    feet, kind = _feet(rng, settee)
    return parts + feet, f"straight-{back}/{kind}/{arm}"


def _back(rng: np.random.Generator, settee: Settee, kind: str, seats: int) -> list[Part]:
    if kind == "tufted":
        return soft.tufted_back(rng, settee)
    if kind == "shaped":
        return [soft.shaped_back(rng, settee)]
    back = [soft.plain_back(settee, over_arms=chance(rng, 0.5))]
    return back + (soft.back_cushions(rng, settee, seats) if kind == "cushions" else [])


def _feet(rng: np.random.Generator, settee: Settee) -> tuple[list[Part], str]:
    if settee.floor < 0.06:
        return [soft.skirt(settee)], "skirt"
    foot = supports.Footprint(
        settee.width * 0.95, settee.depth * 0.92, settee.floor, between(rng, 0.06, 0.11)
    )
    kind = pick(rng, {"block-feet": 3, "splayed-feet": 2, "runner-feet": 1, "plinth": 1})
    if kind == "block-feet":
        return supports.plain_legs(rng, foot), kind
    if kind == "splayed-feet":
        return supports.splayed_legs(rng, foot, bracing=False), kind
    if kind == "runner-feet":
        return supports.sled_runners(rng, foot), kind
    return supports.plinth(rng, foot), kind


def _corner(rng: np.random.Generator) -> tuple[list[Part], str]:
    """L-shape: a straight sofa with a chaise or a second wing on one side."""
    settee = _settee(rng)
    side, run, wide = (
        pick(rng, {1: 1, -1: 1}),
        settee.depth * between(rng, 0.6, 1.1),
        between(rng, 0.65, 0.85),
    )
    kind = pick(rng, {"chaise": 5, "corner": 4})
    parts = [soft.seat_base(settee), soft.plain_back(settee, over_arms=True)]
    parts += soft.seat_cushions(settee, whole(rng, 2, 3))
    parts += soft.back_cushions(rng, settee, whole(rng, 2, 3)) if chance(rng, 0.7) else []
    near_arm, far_arm = soft.block_arms(rng, settee)
    wing = [*_wing(settee, run, wide, wide if kind == "chaise" else wide - settee.arm), far_arm]
    wing.append(near_arm if kind == "chaise" else _wing_back(settee, run))
    parts += wing if side > 0 else [part.mirrored() for part in wing]
    foot = supports.Footprint(settee.width * 0.95, settee.depth * 0.92, settee.floor, between(rng, 0.06, 0.1))
    parts += [soft.skirt(settee)] if settee.floor < 0.06 else supports.plain_legs(rng, foot)
    return parts, f"{kind}-{'left' if side > 0 else 'right'}/feet/block-arms"


def _wing(settee: Settee, run: float, wide: float, padded: float) -> list[Part]:
    """Seat reaching forward by `run` on the +x side; its cushion is `padded` wide, its base `wide`."""
    x, z = settee.width / 2 - wide / 2, settee.depth / 2 + run / 2 - 0.03
    top = settee.seat - 0.14
    base = rounded_box((wide, top - settee.floor, run), (x, (top + settee.floor) / 2, z), 0.02)
    inner = x - (wide - padded) / 2
    pad = rounded_box(
        (padded * 0.98, 0.17, run), (inner, settee.seat - 0.07, z), 0.045, bulge=(0, 0.025, 0.01)
    )
    toe, front = (0.08, settee.floor + 0.02, 0.08), z + run / 2 - 0.1
    toes = [box(toe, (x + s * (wide / 2 - 0.1), settee.floor / 2, front)) for s in (1, -1)]
    return [base, pad, *toes]


def _wing_back(settee: Settee, run: float) -> Part:
    """Back of the second wing, along the +x side."""
    tall = settee.back_top - settee.floor
    x, z = (settee.width - settee.thick) / 2, run / 2
    size = (settee.thick, tall, settee.depth + run - 0.06)
    return rounded_box(size, (x, settee.floor + tall / 2, z), settee.soft)


_WOODEN_STANDS: dict[str, tuple[supports.Support, float]] = {
    "legs": (supports.straight_legs, 2),
    "splayed": (supports.splayed_legs, 2),
    "sled": (supports.sled_runners, 1),
}


def _wooden(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Loose cushions in a frame of bars."""
    seat, leg, pad = between(rng, 0.38, 0.45), between(rng, 0.06, 0.09), between(rng, 0.11, 0.16)
    settee = Settee(
        width=between(rng, 1.3, 1.9),
        depth=between(rng, 0.68, 0.85),
        floor=seat - pad,
        seat=seat,
        arm=leg,
        arm_top=seat + between(rng, 0.14, 0.22),
        back_top=seat + between(rng, 0.36, 0.5),
        thick=0.06,
        soft=0.03,
        tilt=between(rng, 8.0, 18.0),
    )
    rear, front = -settee.depth / 2, settee.depth / 2
    plane = BackPlane(settee.width - leg, settee.back_top - seat, seat - pad, rear + leg / 2, settee.tilt)
    style, make_back = pick_from(rng, {"slatted": (slatted_back, 1), "ladder": (ladder_back, 1)})
    stand, make_stand = pick_from(rng, _WOODEN_STANDS)
    room = ArmRoom(settee.width / 2 - leg * 0.3, seat - pad, settee.arm_top, rear - 0.04, front, leg)
    seats = whole(rng, 2, 3)
    parts = [
        box((settee.width, 0.06, settee.depth), (0, seat - pad - 0.02, 0)),
        *make_back(rng, plane, leg * 0.8),
    ]
    parts += make_stand(rng, supports.Footprint(settee.width, settee.depth, seat - pad, leg))
    parts += soft.seat_cushions(settee, seats) + soft.back_cushions(rng, settee, seats)
    return parts + post_arms(rng, room), f"wooden-{style}/{stand}/post-arms"


def _curved(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A segment of a ring, its back outside."""
    radius, depth = between(rng, 1.0, 1.5), between(rng, 0.68, 0.85)
    angle = np.radians(between(rng, 36.0, 62.0)) * np.linspace(-1, 1, 25)
    seat, floor, thick = between(rng, 0.38, 0.45), between(rng, 0.04, 0.14), between(rng, 0.15, 0.22)
    parts = [
        _ring_slab(angle, (radius - depth, radius), (floor, seat - 0.12)),
        _ring_slab(angle, (radius - depth - 0.01, radius - thick), (seat - 0.14, seat)),
        _ring_wall(rng, angle, radius - thick / 2, floor, thick),
    ]
    spots = [_on_ring(place, r) for place in angle[[2, 12, 22]] for r in (radius - 0.1, radius - depth + 0.1)]
    parts += [box((0.08, floor + 0.02, 0.08), (float(x), floor / 2, float(z))) for x, z in spots]
    return [part.moved((0, 0, depth / 2 - radius)) for part in parts], "curved/feet/wrapped"


def _on_ring(angle: Varying, radius: Varying) -> Float[np.ndarray, "2 *shape"]:
    """x and z on circles about the origin; angle 0 is the rear."""
    return -np.stack([np.sin(angle), np.cos(angle)]) * radius


def _ring_slab(
    angle: Float[np.ndarray, "N"], radii: tuple[float, float], heights: tuple[float, float]
) -> Part:
    """Horizontal segment of a ring."""
    x, z = _on_ring(angle[:, None], np.linspace(*radii, 5))
    y = np.full(x.shape, sum(heights) / 2)
    return panel(np.stack([x, y, z], axis=-1), heights[1] - heights[0])


def _ring_wall(
    rng: np.random.Generator, angle: Float[np.ndarray, "N"], radius: float, floor: float, thick: float
) -> Part:
    """Back of a curved sofa, lower at its ends and leaning out."""
    high = between(rng, 0.7, 0.9)
    low = high - between(rng, 0.0, 0.22)
    s = np.linspace(0, 1, 5)
    top = low + (high - low) * np.cos(angle / angle[-1] * np.pi / 2)[:, None]
    x, z = _on_ring(angle[:, None], radius + between(rng, 0.0, 0.08) * s)
    return panel(np.stack([x, floor + (top - floor) * s, z], axis=-1), thick)


_DAYBED_STANDS: dict[str, tuple[supports.Support, float]] = {
    "legs": (supports.plain_legs, 2),
    "splayed": (supports.splayed_legs, 1),
    "turned": (supports.turned_legs, 1),
}


def _daybed(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A long cushion with one or two raised ends, and perhaps a low back."""
    width, depth, seat = between(rng, 1.6, 2.0), between(rng, 0.7, 0.9), between(rng, 0.38, 0.46)
    pad = between(rng, 0.14, 0.2)
    parts = [
        rounded_box((width, pad, depth), (0, seat - pad / 2, 0), 0.05, bulge=(0, 0.02, 0)),
        box((width, 0.07, depth), (0, seat - pad - 0.02, 0)),
    ]
    end = rounded_box((0.16, between(rng, 0.3, 0.42), depth), (width / 2 - 0.05, seat + 0.12, 0), 0.06)
    end = end.rotated("z", -between(rng, 5.0, 25.0), (width / 2, seat, 0))
    ends = pick(rng, {"one-end": 1, "two-ends": 1})
    parts += [end] if ends == "one-end" else with_mirror([end])
    if chance(rng, 0.5):
        tall, long = between(rng, 0.25, 0.4), width * between(rng, 0.55, 1.0)
        parts.append(rounded_box((long, tall, 0.14), (0, seat + tall / 2 - 0.02, 0.05 - depth / 2), 0.05))
    foot = supports.Footprint(width * 0.95, depth * 0.92, seat - pad - 0.04, between(rng, 0.07, 0.1))
    stand, make_stand = pick_from(rng, _DAYBED_STANDS)
    return parts + make_stand(rng, foot), f"daybed-{ends}/{stand}/no-arms"
