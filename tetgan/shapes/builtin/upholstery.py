"""Stuffed furniture: bases, arms, backs and cushions that armchairs and sofas share."""

from dataclasses import dataclass

import numpy as np

from tetgan.shapes.builtin.draws import between, chance, pick
from tetgan.shapes.builtin.parts import Part, box, panel, rounded_box, sweep, with_mirror
from tetgan.shapes.builtin.parts import ellipse as unit_ellipse


@dataclass(frozen=True)
class Settee:
    """Sizes in metres, heights from the floor; `arm` and `thick` are those of an arm and of the back."""

    width: float
    depth: float
    floor: float
    seat: float
    arm: float
    arm_top: float
    back_top: float
    thick: float
    soft: float
    tilt: float

    @property
    def inner(self) -> float:
        """Width between the arms."""
        return self.width - 2 * self.arm

    @property
    def hinge(self) -> tuple[float, float, float]:
        """Where the back leans from: its lower rear edge."""
        return (0.0, self.floor, -self.depth / 2)


def seat_base(settee: Settee) -> Part:
    """The box under the cushions."""
    top = settee.seat - 0.14
    size = (settee.width - 0.02, top - settee.floor, settee.depth * 0.97)
    return rounded_box(size, (0, (top + settee.floor) / 2, 0), 0.02)


def seat_cushions(settee: Settee, count: int) -> list[Part]:
    """Cushions side by side between the arms."""
    width = (settee.inner + 0.01) / count
    size = (width * 0.995, 0.17, settee.depth - settee.thick)
    z = settee.thick / 2 + 0.005
    return [
        rounded_box(size, (x, settee.seat - 0.07, z), 0.045, bulge=(0, 0.03, 0.012))
        for x in _places(settee.inner, count)
    ]


def back_cushions(rng: np.random.Generator, settee: Settee, count: int) -> list[Part]:
    """Cushions leaning on the back."""
    width = settee.inner / count
    tall = settee.back_top - settee.seat + between(rng, -0.06, 0.05)
    thick = between(rng, 0.12, 0.18)
    middle = (settee.seat - 0.02 + tall / 2, -settee.depth / 2 + settee.thick + thick * 0.3)
    lean = settee.tilt + between(rng, 2.0, 8.0)
    return [
        rounded_box((width * 0.98, tall, thick), (x, *middle), 0.05, bulge=(0, 0.015, 0.035)).rotated(
            "x", -lean, settee.hinge
        )
        for x in _places(settee.inner, count)
    ]


def plain_back(settee: Settee, *, over_arms: bool) -> Part:
    """A stuffed slab; `over_arms` lets it run the whole width."""
    tall = settee.back_top - settee.floor
    width = settee.width if over_arms else settee.inner + 0.02
    middle = (0, settee.floor + tall / 2, -settee.depth / 2 + settee.thick / 2)
    slab = rounded_box((width, tall, settee.thick), middle, settee.soft)
    return slab.rotated("x", -settee.tilt, settee.hinge)


def shaped_back(rng: np.random.Generator, settee: Settee) -> Part:
    """A slab whose top rises in the middle or at the ends."""
    u = np.linspace(-1, 1, 21)
    rise, humps = between(rng, 0.08, 0.2), pick(rng, {1: 3, 2: 1})
    wave = 0.5 + 0.5 * np.cos(np.pi * u * humps)
    top = settee.back_top - rise * (wave if chance(rng, 0.2) else 1 - wave)
    y = settee.floor + (top[:, None] - settee.floor) * np.linspace(0, 1, 6)
    x = np.broadcast_to(u[:, None] * (settee.width - 0.04) / 2, y.shape)
    z = -settee.depth / 2 + settee.thick / 2 - np.tan(np.radians(settee.tilt)) * (y - settee.floor)
    return panel(np.stack([x, y, z], axis=-1), settee.thick * 0.8)


def tufted_back(rng: np.random.Generator, settee: Settee) -> list[Part]:
    """A plain back with a quilted front: rows of swellings between buttons."""
    columns = max(3, round(settee.inner / between(rng, 0.14, 0.22)))
    rows = int(rng.integers(2, 4))
    u, v = np.linspace(0, 1, 4 * columns + 1), np.linspace(0, 1, 4 * rows + 1)
    swell = (
        0.045 * np.abs(np.sin(np.pi * columns * u))[:, None] ** 0.6 * np.abs(np.sin(np.pi * rows * v)) ** 0.6
    )
    y = settee.seat - 0.03 + (settee.back_top - settee.seat) * v
    x = np.broadcast_to(((u - 0.5) * settee.inner)[:, None], swell.shape)
    z = -settee.depth / 2 + settee.thick + swell
    quilt = panel(np.stack([x, np.broadcast_to(y, swell.shape), z], axis=-1), 0.04)
    return [plain_back(settee, over_arms=False), quilt.rotated("x", -settee.tilt, settee.hinge)]


def block_arms(rng: np.random.Generator, settee: Settee) -> list[Part]:
    """Rectangular arms with more or less rounded edges."""
    length = settee.depth * between(rng, 0.86, 1.0)
    size = (settee.arm, settee.arm_top - settee.floor, length)
    middle = (
        settee.width / 2 - settee.arm / 2,
        (settee.arm_top + settee.floor) / 2,
        (settee.depth - length) / -2,
    )
    return with_mirror([rounded_box(size, middle, settee.soft, bulge=(0.01, 0.01, 0))])


def rolled_arms(rng: np.random.Generator, settee: Settee) -> list[Part]:
    """Arms ending in a roll along the top."""
    radius = settee.arm * between(rng, 0.55, 0.75)
    out = between(rng, 0.0, 0.3) * radius
    x, top = settee.width / 2 - settee.arm / 2, settee.arm_top - radius
    front = settee.depth / 2 * between(rng, 0.88, 1.0)
    wall = box(
        (settee.arm * 0.85, top - settee.floor, front + settee.depth / 2 - 0.02),
        (x, (top + settee.floor) / 2, (front - settee.depth / 2) / 2),
    )
    path = [(x + out, top, -settee.depth / 2), (x + out, top, front)]
    return with_mirror([wall, sweep(path, unit_ellipse(16) * radius)])


def sloped_arms(rng: np.random.Generator, settee: Settee) -> list[Part]:
    """Arms falling from the back to the front."""
    z = np.linspace(-settee.depth / 2, settee.depth / 2 * between(rng, 0.8, 1.0), 9)
    s = np.linspace(0, 1, 9)
    high = settee.arm_top + between(rng, 0.3, 0.9) * (settee.back_top - settee.arm_top)
    top = high + (settee.seat + 0.05 - high) * s ** between(rng, 0.8, 2.5)
    y = settee.floor + (top[:, None] - settee.floor) * np.linspace(0, 1, 4)
    x = np.full_like(y, settee.width / 2 - settee.arm / 2)
    grid = np.stack([x, y, np.broadcast_to(z[:, None], y.shape)], axis=-1)
    return with_mirror([panel(grid[::-1], settee.arm)])


def wings(settee: Settee) -> list[Part]:
    """Side pieces of a wing chair, above the arms and in front of the back."""
    size = (0.09, settee.back_top - settee.arm_top + 0.04, settee.depth * 0.36)
    middle = (settee.width / 2 - settee.arm / 2, (settee.back_top + settee.arm_top) / 2, -settee.depth * 0.3)
    return with_mirror([rounded_box(size, middle, 0.035).rotated("x", -settee.tilt, settee.hinge)])


def skirt(settee: Settee) -> Part:
    """Cloth to the floor, or a recessed plinth."""
    height = settee.floor + 0.02
    return box((settee.width * 0.97, height, settee.depth * 0.95), (0, height / 2, 0))


def throw_pillows(rng: np.random.Generator, settee: Settee) -> list[Part]:
    """One or two loose pillows in the corners."""
    edge = between(rng, 0.32, 0.42)
    pillow = rounded_box((edge, edge, 0.1), (0, 0, 0), 0.045, bulge=(0, 0, 0.04))
    pillow = pillow.rotated("x", -between(rng, 15.0, 25.0)).rotated("y", -between(rng, 10.0, 35.0))
    x = settee.inner / 2 - edge * 0.55
    placed = pillow.moved((x, settee.seat + edge * 0.5, -settee.depth / 2 + settee.thick + 0.2))
    return with_mirror([placed]) if chance(rng, 0.5) else [placed]


def _places(width: float, count: int) -> list[float]:
    """Middles of `count` equal pieces of a width about 0."""
    return [float(width * ((i + 0.5) / count - 0.5)) for i in range(count)]
