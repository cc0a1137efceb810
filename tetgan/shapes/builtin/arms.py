"""Arm rests, built for the right side (x > 0) and mirrored."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from tetgan.shapes.builtin.draws import between, chance
from tetgan.shapes.builtin.parts import SQUARE, Part, bar, panel, rounded_box, sweep, tube, with_mirror


@dataclass(frozen=True)
class ArmRoom:
    """Space for an arm, in metres.

    `x` is the plane of its middle, `seat` and `height` the tops of the seat and of the arm, `back` and
    `front` its ends in z, and `rear` is x where it meets the back if that is narrower than the seat.
    """

    x: float
    seat: float
    height: float
    back: float
    front: float
    thickness: float
    rear: float | None = None

    def across(self, s: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N"]:
        """x along the arm, from the back (s = 0) to the front (s = 1)."""
        rear = self.x if self.rear is None else self.rear
        return self.x + (rear - self.x) * (1 - s) ** 2


def post_arms(rng: np.random.Generator, room: ArmRoom) -> list[Part]:
    """A rail from the back to a front post, flat, round or padded."""
    front = room.front - between(rng, 0.02, 0.1)
    s = np.linspace(0, 1, 9)
    x = room.across(s) + between(rng, 0.0, 0.05) * np.sin(np.pi * s)
    y = room.height - between(rng, -0.02, 0.05) * s**2
    rail = np.stack([x, y, room.back + (front - room.back) * s], axis=1)
    flat = room.thickness / 2 * np.array([between(rng, 0.9, 1.7), 0.9])
    post = [(room.x, room.seat - 0.05, front - 0.02), (room.x, room.height, front - 0.02)]
    parts = [sweep(rail, SQUARE * flat, up=(0, 1, 0)), tube(post, room.thickness * 0.9)]
    if chance(rng, 0.3):
        parts.append(_pad(room, front))
    return with_mirror(parts)


def loop_arms(rng: np.random.Generator, room: ArmRoom) -> list[Part]:
    """A bent tube from the side of the seat, up, and into the back."""
    t = np.linspace(0, np.pi / 2, 11)
    power = between(rng, 0.5, 0.9)
    y = room.seat - 0.04 + (room.height - room.seat + 0.04) * np.sin(t) ** power
    z = room.back + (room.front - 0.05 - room.back) * np.cos(t) ** power
    path = np.stack([room.across(np.cos(t) ** power), y, z], axis=1)
    return with_mirror([tube(path, room.thickness * 0.9, up=(1, 0, 0))])


def pad_arms(rng: np.random.Generator, room: ArmRoom) -> list[Part]:
    """Office arms: one post in the middle with a pad on top."""
    thick, low = room.thickness, room.seat - 0.07
    z = (room.back + room.front) / 2 + between(rng, -0.03, 0.05)
    foot = z + between(rng, -0.05, 0.05)
    x = room.x + thick * 0.5
    post = bar((x, low, foot), (x, room.height, z), thick * np.array([0.8, 1.3]), square=True)
    link = bar((x, low, foot), (x - 0.12, low, foot), thick * 0.8, square=True)
    length = (room.front - room.back) * between(rng, 0.5, 0.7)
    pad = rounded_box((thick * 1.8, thick * 0.9, length), (x, room.height, z), thick * 0.4)
    return with_mirror([post, link, pad])


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
