"""Backs of chairs and benches: boards, slats, spindles and frames on one bent plane behind the seat."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from tetgan.shapes.builtin.draws import between, chance, pick, whole
from tetgan.shapes.builtin.parts import SQUARE, Part, Varying, ellipse, loft, panel, sheet, sweep, tube

OVERLAP = 0.03  # metres a back reaches below the top of its seat


@dataclass(frozen=True)
class BackPlane:
    """A plane that leans back and bends: `u` in -1..1 runs across it, `s` in 0..1 up from the seat.

    Lengths are metres: `sway` bends it backwards to the top, `bow` hollows it across; `flare` is its width
    at the top over that at the seat.
    """

    width: float
    height: float
    seat: float
    z: float
    tilt: float = 5.0
    sway: float = 0.0
    bow: float = 0.0
    flare: float = 1.0

    def point(self, u: Varying, s: Varying) -> Float[np.ndarray, "*shape 3"]:
        u, s = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(s, dtype=float))
        lean = np.radians(self.tilt)
        x = u * self.width / 2 * (1 + (self.flare - 1) * s)
        y = self.seat + s * self.height * np.cos(lean)
        z = self.z - s * self.height * np.sin(lean) - self.sway * s**2 - self.bow * (1 - u**2)
        return np.stack([x, y, z], axis=-1)

    def grid(self, u: Varying, low: Varying, high: Varying, rows: int = 9) -> Float[np.ndarray, "N M 3"]:
        """Points between two curves `low(u)` and `high(u)`, rows across so that faces look forward."""
        u = np.asarray(u, dtype=float)
        low, high = np.broadcast_to(low, u.shape), np.broadcast_to(high, u.shape)
        t = np.linspace(0, 1, rows)
        return self.point(u[:, None], low[:, None] + (high - low)[:, None] * t)

    @property
    def bays(self) -> float:
        """Width over that of an ordinary chair: a bench needs more bars in its back."""
        return max(1.0, self.width / 0.5)

    @property
    def overlap(self) -> float:
        """`s` of the line just below the top of the seat."""
        return -OVERLAP / self.height


Back = Callable[[np.random.Generator, BackPlane, float], list[Part]]


def solid_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """One board; straight, arched, round-shouldered or dipped top."""
    u = np.linspace(-1, 1, 13)
    crowns = {
        "straight": np.ones(13),
        "arched": 1 - between(rng, 0.1, 0.35) * u**2,
        "shouldered": 1 - 0.45 * np.abs(u) ** 5,
        "dipped": 0.85 + 0.15 * u**2,
    }
    high = crowns[pick(rng, {"straight": 3, "arched": 3, "shouldered": 2, "dipped": 1})]
    if chance(rng, 0.75):
        return [panel(plane.grid(u, plane.overlap, high), thickness)]
    low = between(rng, 0.15, 0.35)
    return [
        panel(plane.grid(u, low, high), thickness),
        *_posts(rng, plane, thickness, u=0.75, top=low + 0.15),
    ]


def padded_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Board with an upholstered pad that swells towards the sitter."""
    u, t = np.linspace(-1, 1, 13), np.linspace(0, 1, 9)
    low, narrow = between(rng, 0.03, 0.2), between(rng, 0.86, 0.97)
    pad = plane.grid(u * narrow, low, 0.99)
    pad[..., 2] += thickness * (0.25 + between(rng, 0.4, 0.9) * (1 - u**4)[:, None] * (1 - (2 * t - 1) ** 4))
    return [panel(plane.grid(u, plane.overlap, 0.97), thickness * 0.7), panel(pad, thickness)]


def slatted_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Upright slats between a bottom and a top rail, framed by posts."""
    count = round(whole(rng, 3, 6) * plane.bays)
    low = between(rng, 0.1, 0.25)
    width = plane.width / count * between(rng, 0.35, 0.6)
    slat = np.array([width / 2, thickness * 0.3])
    parts = _posts(rng, plane, thickness)
    parts += [
        _rail(plane, low, thickness),
        _rail(plane, 0.94, thickness * between(rng, 1.0, 2.0), thickness * 0.8),
    ]
    for u in np.linspace(-1, 1, count + 2)[1:-1]:
        parts.append(sweep(plane.point(u, np.linspace(low, 0.95, 5)), SQUARE * slat, up=(0, 0, 1)))
    return parts


def spindle_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Round rods fanning from the seat into a top rail."""
    count = round(whole(rng, 4, 8) * plane.bays)
    rod = thickness * between(rng, 0.4, 0.6)
    high = thickness * between(rng, 1.2, 2.6)
    parts = [_rail(plane, 0.95, high, thickness * 0.8)]
    framed = chance(rng, 0.5)
    parts += _posts(rng, plane, thickness) if framed else []
    for u in np.linspace(-1, 1, count + 2)[1:-1] if framed else np.linspace(-0.92, 0.92, count):
        parts.append(tube(plane.point(u, np.linspace(plane.overlap, 0.96, 5)), rod))
    return parts


def ladder_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Rungs across two posts."""
    count = whole(rng, 2, 5)
    pitch = 0.85 / count
    tall = plane.height * pitch * between(rng, 0.4, 0.65)
    heights = np.linspace(1 - pitch * 0.45, 1 - pitch * 0.45 - pitch * (count - 1), count)
    return _posts(rng, plane, thickness) + [_rail(plane, s, tall, thickness * 0.6) for s in heights]


def open_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Only a frame: two posts and a top rail, or one bent tube."""
    if chance(rng, 0.5):
        return [
            *_posts(rng, plane, thickness),
            _rail(plane, 0.93, thickness * between(rng, 1.2, 3.5), thickness),
        ]
    s, u = _arch(between(rng, 0.2, 0.55))
    parts = [tube(plane.point(u, plane.overlap + s * (1 - plane.overlap)), thickness)]
    return [*parts, _rail(plane, between(rng, 0.3, 0.6), thickness * 0.9)] if chance(rng, 0.4) else parts


def cross_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Posts and rails holding an X."""
    low = between(rng, 0.12, 0.3)
    parts = [
        *_posts(rng, plane, thickness),
        _rail(plane, low, thickness),
        _rail(plane, 0.94, thickness * 1.4, thickness),
    ]
    t = np.linspace(0, 1, 7)
    bend = between(rng, 0.0, 0.35) * np.sin(np.pi * t)
    for side in (1, -1):
        u = side * (np.linspace(-0.95, 0.95, 7) * (1 - bend))
        parts.append(sweep(plane.point(u, low + (0.93 - low) * t), SQUARE * thickness * 0.35, up=(0, 0, 1)))
    return parts


def splat_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Posts, a top rail and one shaped board in the middle."""
    t = np.linspace(0, 1, 11)
    waves = pick(rng, {"vase": 2, "fiddle": 2, "plain": 1})
    half = between(rng, 0.25, 0.4)
    shape = {
        "vase": 0.7 + 0.3 * np.sin(2.2 * np.pi * t - 0.4),
        "fiddle": 0.7 + 0.3 * np.cos(3 * np.pi * t),
        "plain": np.linspace(0.7, 1.2, 11),
    }[waves]
    across = np.linspace(-1, 1, 5)
    grid = plane.point(across[:, None] * (half * shape), plane.overlap + (0.95 - plane.overlap) * t)
    top = _rail(plane, 0.94, thickness * between(rng, 1.4, 2.4), thickness * 0.9)
    return [*_posts(rng, plane, thickness), top, panel(grid, thickness * 0.5)]


def hoop_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Bent hoop filled with spindles, as on a Windsor chair."""
    power = between(rng, 0.3, 0.6)
    s, u = _arch(power)
    parts = [tube(plane.point(u, plane.overlap + s * (1 - plane.overlap)), thickness * 0.85)]
    count = whole(rng, 4, 7)
    for place in np.linspace(-0.75, 0.75, count):
        top = (1 - abs(place) ** (1 / power)) ** power
        line = np.linspace(plane.overlap, min(top, 0.97), 4)
        parts.append(tube(plane.point(place * np.linspace(0.85, 1.0, 4), line), thickness * 0.45))
    return parts


def medallion_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Oval or rounded frame on two short posts, with a pad inside."""
    angle = np.linspace(0, 2 * np.pi, 25)
    low, exponent = between(rng, 0.15, 0.3), pick(rng, {2.0: 3, 3.5: 1})
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    unit = np.sign(circle) * np.abs(circle) ** (2 / exponent)
    middle, half = (1 + low) / 2, (1 - low) / 2
    ring = plane.point(unit[:, 0] * 0.95, middle + half * unit[:, 1])
    pad = loft(ring[None, :-1] + thickness * np.array([[[0, 0, -0.35]], [[0, 0, 0.35]]]))
    return [tube(ring, thickness), pad, *_posts(rng, plane, thickness, u=0.5, top=low + 0.12)]


def lattice_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Posts with a grid of upright and level bars."""
    low = between(rng, 0.15, 0.3)
    parts = [*_posts(rng, plane, thickness)]
    parts += [
        _rail(plane, s, thickness * 0.7, thickness * 0.6) for s in np.linspace(low, 0.95, whole(rng, 3, 4))
    ]
    for u in np.linspace(-1, 1, round(whole(rng, 2, 4) * plane.bays) + 2)[1:-1]:
        parts.append(
            tube(plane.point(u, np.linspace(low, 0.95, 4)), thickness * 0.6, square=True, up=(0, 0, 1))
        )
    return parts


def caned_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """Frame of posts and rails around a thin panel, or an open sheet of cane."""
    low = between(rng, 0.12, 0.3)
    grid = plane.grid(np.linspace(-0.97, 0.97, 7), low, 0.95, rows=5)
    filling = sheet(grid) if chance(rng, 0.5) else panel(grid, thickness * 0.35)
    rails = [_rail(plane, low, thickness), _rail(plane, 0.95, thickness)]
    return [*_posts(rng, plane, thickness), *rails, filling]


def floating_back(rng: np.random.Generator, plane: BackPlane, thickness: float) -> list[Part]:
    """A short board held high on two posts."""
    u = np.linspace(-1, 1, 11)
    low, round_off = between(rng, 0.45, 0.65), between(rng, 0.0, 0.12)
    board = plane.grid(u, low + round_off * u**4, 1 - round_off * u**4)
    spread = between(rng, 0.35, 0.9)
    return [panel(board, thickness), *_posts(rng, plane, thickness * 0.8, u=spread, top=low + 0.2)]


def _posts(
    rng: np.random.Generator, plane: BackPlane, thickness: float, *, u: float = 1.0, top: float = 1.0
) -> list[Part]:
    """The two uprights of a back, from below the seat's top to `top`."""
    s = np.linspace(plane.overlap, top, 6)
    square = chance(rng, 0.5)
    return [tube(plane.point(side * u, s), thickness, square=square, up=(0, 0, 1)) for side in (1, -1)]


def _rail(plane: BackPlane, s: float, tall: float, thick: float | None = None) -> Part:
    """Bar across the back at height `s`; `tall` and `thick` in metres."""
    thick = tall if thick is None else thick
    section = (SQUARE if tall > 1.3 * thick else ellipse(10, 3.0)) * np.array([thick / 2, tall / 2])
    return sweep(plane.point(np.linspace(-1, 1, 9), s), section, up=(0, 1, 0))


def _arch(power: float) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N"]]:
    """(s, u) of a hoop standing on both ends: superellipse with exponent 1 / power."""
    angle = np.linspace(0, np.pi, 19)
    u = np.cos(angle)
    return np.clip(1 - np.abs(u) ** (1 / power), 0, 1) ** power, u
