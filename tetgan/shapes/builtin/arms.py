"""Arm rests, built for the right side (x > 0) and mirrored."""

from dataclasses import dataclass

import numpy as np

from tetgan.shapes.builtin.draws import between, chance
from tetgan.shapes.builtin.parts import SQUARE, Part, bar, panel, rounded_box, sweep, tube, with_mirror


@dataclass(frozen=True)
class ArmRoom:
    """Where an arm fits, in metres: plane x of its middle, seat top, height of the arm, back and front in z."""

    x: float
    seat: float
    height: float
    back: float
    front: float
    thickness: float


def post_arms(rng: np.random.Generator, room: ArmRoom) -> list[Part]:
    """A rail from the back to a front post, flat, round or padded."""
    front = room.front - between(rng, 0.02, 0.1)
    out = between(rng, 0.0, 0.05)
    s = np.linspace(0, 1, 7)
    drop = between(rng, -0.02, 0.05) * s**2
    rail = np.stack(
        [room.x + out * np.sin(np.pi * s), room.height - drop, room.back + (front - room.back) * s], 1
    )
    width = room.thickness * between(rng, 0.9, 1.7)
    section = np.array([room.thickness * 0.45, width / 2])
    post = bar(
        (room.x, room.seat - 0.05, front - 0.02), (room.x, room.height, front - 0.02), room.thickness * 0.9
    )
    parts = [sweep(rail, SQUARE * section[::-1], up=(0, 1, 0)), post]
    if chance(rng, 0.3):
        parts.append(_pad(room, front))
    return with_mirror(parts)


def loop_arms(rng: np.random.Generator, room: ArmRoom) -> list[Part]:
    """A bent tube from the side of the seat, up, and into the back."""
    t = np.linspace(0, np.pi / 2, 9)
    power = between(rng, 0.5, 0.9)
    y = room.seat - 0.04 + (room.height - room.seat + 0.04) * np.sin(t) ** power
    z = room.back + (room.front - 0.05 - room.back) * np.cos(t) ** power
    return with_mirror([tube(np.stack([np.full(9, room.x), y, z], 1), room.thickness * 0.9, up=(1, 0, 0))])


def pad_arms(rng: np.random.Generator, room: ArmRoom) -> list[Part]:
    """Office arms: one post in the middle with a pad on top."""
    z = (room.back + room.front) / 2 + between(rng, -0.03, 0.05)
    lean = between(rng, -0.05, 0.05)
    x = room.x + room.thickness * 0.5
    post = bar(
        (x, room.seat - 0.07, z + lean),
        (x, room.height, z),
        room.thickness * np.array([0.8, 1.3]),
        square=True,
    )
    foot = bar(
        (x, room.seat - 0.07, z + lean),
        (x - 0.12, room.seat - 0.07, z + lean),
        room.thickness * 0.8,
        square=True,
    )
    length = (room.front - room.back) * between(rng, 0.5, 0.7)
    pad = rounded_box(
        (room.thickness * 1.8, room.thickness * 0.9, length), (x, room.height, z), room.thickness * 0.4
    )
    return with_mirror([post, foot, pad])


def wall_arms(rng: np.random.Generator, room: ArmRoom) -> list[Part]:
    """Closed boards from the seat to the arm, sloping or curved along the top."""
    z = np.linspace(room.back, room.front - between(rng, 0.0, 0.06), 9)
    s = np.linspace(0, 1, 9)
    slope = between(rng, 0.0, 0.5) * (room.height - room.seat)
    top = room.height - slope * s ** between(rng, 1.0, 3.0)
    t = np.linspace(0, 1, 5)
    y = room.seat - 0.05 + (top[:, None] - room.seat + 0.05) * t
    grid = np.stack([np.full_like(y, room.x), y, np.broadcast_to(z[:, None], y.shape)], axis=-1)
    return with_mirror([panel(grid[::-1], room.thickness * between(rng, 0.7, 1.3))])


def _pad(room: ArmRoom, front: float) -> Part:
    length = 0.6 * (front - room.back)
    size = (room.thickness * 1.5, room.thickness * 0.8, length)
    return rounded_box(
        size, (room.x, room.height + room.thickness * 0.5, front - 0.6 * length), room.thickness * 0.35
    )
