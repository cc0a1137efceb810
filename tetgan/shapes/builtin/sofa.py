"""Sofas: upholstered in several manners, wooden-framed, L-shaped, curved, and day beds."""

import numpy as np

from tetgan.shapes.builtin import supports
from tetgan.shapes.builtin import upholstery as soft
from tetgan.shapes.builtin.arms import ArmRoom, post_arms
from tetgan.shapes.builtin.backs import BackPlane, ladder_back, slatted_back
from tetgan.shapes.builtin.draws import between, chance, pick, whole
from tetgan.shapes.builtin.parts import Part, box, panel, rounded_box, with_mirror
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
        tilt=between(rng, 0, 9),
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
    arm = settee.arm
    run = settee.depth * between(rng, 0.6, 1.1)
    wing = between(rng, 0.65, 0.85)
    side = pick(rng, {1.0: 1, -1.0: 1})
    chaise = chance(rng, 0.55)
    parts = [soft.seat_base(settee), soft.plain_back(settee, over_arms=True)]
    parts += soft.seat_cushions(settee, whole(rng, 2, 3))
    if chance(rng, 0.7):
        parts += soft.back_cushions(rng, settee, whole(rng, 2, 3))
    arms = soft.block_arms(rng, settee)
    x = side * (settee.width / 2 - wing / 2)
    z = settee.depth / 2 + run / 2 - 0.03
    base_top = settee.seat - 0.14
    parts.append(
        rounded_box((wing, base_top - settee.floor, run), (x, (base_top + settee.floor) / 2, z), 0.02)
    )
    pad_x, pad = (x, wing) if chaise else (x - side * arm / 2, wing - arm)
    parts.append(
        rounded_box((pad * 0.98, 0.17, run), (pad_x, settee.seat - 0.07, z), 0.045, bulge=(0, 0.025, 0.01))
    )
    parts.append(arms[1] if side > 0 else arms[0])
    if chaise:
        parts.append(arms[0] if side > 0 else arms[1])
    else:
        tall = settee.back_top - settee.floor
        wall = (settee.thick, tall, settee.depth + run - 0.06)
        parts.append(
            rounded_box(
                wall,
                (side * (settee.width - settee.thick) / 2, settee.floor + tall / 2, run / 2),
                settee.soft,
            )
        )
    foot = supports.Footprint(settee.width * 0.95, settee.depth * 0.92, settee.floor, between(rng, 0.06, 0.1))
    parts += [soft.skirt(settee)] if settee.floor < 0.06 else supports.plain_legs(rng, foot)
    front = box((wing * 0.85, settee.floor + 0.02, 0.08), (x, settee.floor / 2, z + run / 2 - 0.1))
    return [
        *parts,
        front,
    ], f"{'chaise' if chaise else 'corner'}-{'right' if side < 0 else 'left'}/feet/block-arms"


def _wooden(rng: np.random.Generator) -> tuple[list[Part], str]:
    """Loose cushions in a frame of bars."""
    width, depth = between(rng, 1.3, 1.9), between(rng, 0.68, 0.85)
    seat, leg, pad = between(rng, 0.38, 0.45), between(rng, 0.06, 0.09), between(rng, 0.11, 0.16)
    back, tilt, seats = between(rng, 0.36, 0.5), between(rng, 8, 18), whole(rng, 2, 3)
    foot = supports.Footprint(width, depth, seat - pad, leg)
    plane = BackPlane(width - leg, back, seat - pad, -depth / 2 + leg / 2, tilt)
    room = ArmRoom(
        width / 2 - leg * 0.3, seat - pad, seat + between(rng, 0.14, 0.22), -depth / 2 - 0.04, depth / 2, leg
    )
    style = pick(rng, {slatted_back: 1, ladder_back: 1})
    support = pick(rng, {"legs": 2, "splayed": 2, "sled": 1})
    stand = {"legs": supports.straight_legs, "splayed": supports.splayed_legs, "sled": supports.sled_runners}[
        support
    ]
    parts = [
        box((width, 0.06, depth), (0, seat - pad - 0.02, 0)),
        *stand(rng, foot),
        *style(rng, plane, leg * 0.8),
    ]
    settee = Settee(width, depth, seat - pad, seat, leg, seat, seat + back, 0.06, 0.03, tilt)
    parts += soft.seat_cushions(settee, seats) + soft.back_cushions(rng, settee, seats)
    return parts + post_arms(rng, room), f"wooden/{support}/post-arms"


def _curved(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A segment of a ring, its back outside."""
    radius, half = between(rng, 1.0, 1.5), np.radians(between(rng, 36, 62))
    depth, seat, back = between(rng, 0.68, 0.85), between(rng, 0.38, 0.45), between(rng, 0.7, 0.9)
    floor = between(rng, 0.04, 0.14)
    angle = np.linspace(-half, half, 25)

    def ring(inner: float, outer: float, low: float, high: float, steps: int = 5) -> Part:
        r = np.linspace(inner, outer, steps)
        x, z = -np.sin(angle)[:, None] * r, radius - np.cos(angle)[:, None] * r
        middle = np.full(x.shape, (low + high) / 2)
        return panel(np.stack([x, middle, z], axis=-1), high - low)

    thick = between(rng, 0.15, 0.22)
    parts = [
        ring(radius - depth, radius, floor, seat - 0.12),
        ring(radius - depth - 0.01, radius - thick, seat - 0.14, seat),
    ]
    lower = back - between(rng, 0.0, 0.22)
    s = np.linspace(0, 1, 5)
    top = lower + (back - lower) * np.cos(angle / half * np.pi / 2)
    y = floor + (top[:, None] - floor) * s
    r = radius - thick / 2 + between(rng, 0.0, 0.08) * s
    wall = np.stack([-np.sin(angle)[:, None] * r, y, radius - np.cos(angle)[:, None] * r], axis=-1)
    parts.append(panel(wall, thick))
    for place in angle[[2, 12, 22]]:
        for r_leg in (radius - 0.1, radius - depth + 0.1):
            spot = (-np.sin(place) * r_leg, floor / 2, radius - np.cos(place) * r_leg)
            parts.append(box((0.08, floor + 0.02, 0.08), spot))
    return [part.moved((0, 0, -depth / 2)) for part in parts], "curved/feet/wrapped"


def _daybed(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A long cushion with one or two raised ends, or a low rail behind."""
    width, depth, seat = between(rng, 1.6, 2.0), between(rng, 0.7, 0.9), between(rng, 0.38, 0.46)
    pad, leg = between(rng, 0.14, 0.2), between(rng, 0.07, 0.1)
    mattress = rounded_box((width, pad, depth), (0, seat - pad / 2, 0), 0.05, bulge=(0, 0.02, 0))
    frame = box((width, 0.07, depth), (0, seat - pad - 0.02, 0))
    end = rounded_box((0.16, between(rng, 0.3, 0.42), depth), (width / 2 - 0.05, seat + 0.12, 0), 0.06)
    end = end.rotated("z", -between(rng, 5, 25), (width / 2, seat, 0))
    ends = pick(rng, {"one-end": 1, "two-ends": 1})
    parts = [mattress, frame, *([end] if ends == "one-end" else with_mirror([end]))]
    if chance(rng, 0.5):
        tall = between(rng, 0.25, 0.4)
        parts.append(
            rounded_box(
                (width * between(rng, 0.55, 1.0), tall, 0.14),
                (0, seat + tall / 2 - 0.02, -depth / 2 + 0.05),
                0.05,
            )
        )
    foot = supports.Footprint(width * 0.95, depth * 0.92, seat - pad - 0.04, leg)
    stand = pick(rng, {"legs": 2, "splayed": 1, "turned": 1})
    make = {"legs": supports.plain_legs, "splayed": supports.splayed_legs, "turned": supports.turned_legs}[
        stand
    ]
    return parts + make(rng, foot), f"daybed-{ends}/{stand}/no-arms"
