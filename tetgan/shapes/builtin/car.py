"""Cars: a lower body with wheel wells, a greenhouse of glass and pillars, wheels and trim."""

from dataclasses import dataclass

import numpy as np

from tetgan.shapes.builtin.draws import between, chance, pick
from tetgan.shapes.builtin.parts import Part, bar, box, ellipse, lathe, loft, rounded_box, tube, with_mirror


@dataclass(frozen=True)
class Style:
    """A kind of car.

    Sizes are ranges in metres. `deck` is the upper line of the lower body, (share of the length from the
    rear, height over the belt line). `glass` is where the greenhouse starts and ends at the belt and at the
    roof: rear low, rear high, front high, front low, as shares of the length; None for an open car.
    """

    length: tuple[float, float]
    width: tuple[float, float]
    height: tuple[float, float]
    belt: tuple[float, float]  # share of the height
    clearance: tuple[float, float]
    wheel: tuple[float, float]  # radius
    deck: tuple[tuple[float, float], ...]
    glass: tuple[float, float, float, float] | None
    weight: float


_SEDAN = ((0.0, 0.93), (0.06, 1.0), (0.25, 1.0), (0.6, 1.0), (0.72, 0.97), (0.93, 0.82), (1.0, 0.68))

_HATCH = ((0.0, 0.95), (0.05, 1.0), (0.3, 1.0), (0.66, 1.0), (0.76, 0.96), (0.94, 0.80), (1.0, 0.66))

_WEDGE = ((0.0, 0.98), (0.08, 1.04), (0.3, 1.0), (0.55, 0.97), (0.68, 0.92), (0.92, 0.66), (1.0, 0.5))

_BOXY = ((0.0, 0.97), (0.03, 1.0), (0.3, 1.0), (0.68, 1.0), (0.74, 0.98), (0.96, 0.9), (1.0, 0.8))

_VAN = ((0.0, 0.98), (0.02, 1.0), (0.3, 1.0), (0.8, 1.0), (0.86, 0.95), (0.97, 0.78), (1.0, 0.65))

_ROUND = ((0.0, 0.45), (0.06, 0.72), (0.18, 0.93), (0.3, 1.0), (0.7, 0.98), (0.9, 0.82), (1.0, 0.45))

_TRUCK = ((0.0, 0.98), (0.02, 1.0), (0.3, 1.0), (0.62, 1.0), (0.72, 1.0), (0.95, 0.93), (1.0, 0.82))


# fmt: off
STYLES: dict[str, Style] = {
    "sedan": Style((4.4, 5.0), (1.75, 1.9), (1.40, 1.52), (0.60, 0.66), (0.17, 0.22), (0.30, 0.35),
        _SEDAN, (0.13, 0.27, 0.55, 0.72), 4.0),
    "coupe": Style((4.2, 4.7), (1.75, 1.9), (1.28, 1.40), (0.62, 0.68), (0.14, 0.19), (0.31, 0.36),
        _SEDAN, (0.06, 0.30, 0.50, 0.70), 2.0),
    "hatchback": Style((3.6, 4.3), (1.65, 1.82), (1.45, 1.6), (0.57, 0.63), (0.16, 0.21), (0.29, 0.34),
        _HATCH, (0.02, 0.10, 0.58, 0.78), 3.0),
    "wagon": Style((4.5, 5.0), (1.75, 1.9), (1.42, 1.58), (0.60, 0.65), (0.17, 0.22), (0.31, 0.35),
        _HATCH, (0.02, 0.07, 0.55, 0.72), 2.0),
    "suv": Style((4.3, 5.0), (1.82, 2.0), (1.68, 1.9), (0.58, 0.64), (0.24, 0.32), (0.36, 0.42),
        _BOXY, (0.02, 0.07, 0.58, 0.72), 3.0),
    "offroad": Style((3.8, 4.4), (1.7, 1.85), (1.75, 1.95), (0.56, 0.62), (0.28, 0.36), (0.38, 0.44),
        _BOXY, (0.02, 0.04, 0.62, 0.68), 2.0),
    "van": Style((4.5, 5.4), (1.85, 2.05), (1.9, 2.3), (0.50, 0.56), (0.2, 0.27), (0.32, 0.37),
        _VAN, (0.01, 0.03, 0.72, 0.90), 2.0),
    "pickup": Style((5.0, 5.6), (1.85, 2.0), (1.7, 1.88), (0.56, 0.62), (0.27, 0.34), (0.37, 0.43),
        _TRUCK, (0.40, 0.43, 0.60, 0.71), 2.5),
    "sports": Style((4.1, 4.6), (1.82, 2.0), (1.12, 1.26), (0.64, 0.70), (0.11, 0.15), (0.32, 0.36),
        _WEDGE, (0.10, 0.36, 0.48, 0.70), 2.5),
    "convertible": Style((4.0, 4.6), (1.72, 1.9), (1.22, 1.35), (0.66, 0.72), (0.14, 0.18), (0.31, 0.35),
        _SEDAN, None, 1.5),
    "micro": Style((2.8, 3.4), (1.5, 1.65), (1.45, 1.6), (0.54, 0.6), (0.16, 0.2), (0.27, 0.31),
        _VAN, (0.02, 0.10, 0.62, 0.88), 1.5),
    "beetle": Style((3.8, 4.2), (1.6, 1.75), (1.42, 1.52), (0.58, 0.63), (0.17, 0.22), (0.31, 0.35),
        _ROUND, (0.14, 0.34, 0.54, 0.70), 1.5),
}


# fmt: on


@dataclass(frozen=True)
class Body:
    """One car's sizes in metres; z runs from -length / 2 at the rear."""

    length: float
    half: float
    height: float
    belt: float
    clearance: float
    wheel: float
    rear_axle: float
    front_axle: float
    squareness: float

    def along(self, share: float) -> float:
        return (share - 0.5) * self.length


def make_car(rng: np.random.Generator) -> tuple[list[Part], str]:
    """One car and its kind."""
    name = pick(rng, {name: style.weight for name, style in STYLES.items()})
    style = STYLES[name]
    body = _body_sizes(rng, style)
    parts = [*_lower_body(rng, body, style), *_wheels(rng, body), *_trim(rng, body)]
    extras = []
    if style.glass is None:
        parts += _cockpit(rng, body)
    else:
        parts += _greenhouse(rng, body, style.glass)
    if name == "pickup":
        parts += _load_bed(body)
    if name in ("suv", "wagon", "offroad") and chance(rng, 0.5):
        parts += _roof_rack(body, style)
        extras.append("rack")
    if name in ("sports", "coupe") and chance(rng, 0.5):
        parts += _spoiler(rng, body)
        extras.append("spoiler")
    if name in ("offroad", "suv") and chance(rng, 0.35):
        parts.append(_spare_wheel(body))
        extras.append("spare")
    return parts, f"{name}/{'+'.join(extras) or 'plain'}"


def _body_sizes(rng: np.random.Generator, style: Style) -> Body:
    length, height = between(rng, *style.length), between(rng, *style.height)
    wheel = between(rng, *style.wheel)
    return Body(
        length=length,
        half=between(rng, *style.width) / 2,
        height=height,
        belt=height * between(rng, *style.belt),
        clearance=between(rng, *style.clearance),
        wheel=wheel,
        rear_axle=-length / 2 + length * between(rng, 0.17, 0.22),
        front_axle=length / 2 - length * between(rng, 0.16, 0.21),
        squareness=between(rng, 3.5, 9.0),
    )


def _lower_body(rng: np.random.Generator, body: Body, style: Style) -> list[Part]:
    """Upper shell over the wheels, and below it sills and bumpers with gaps where the wheels stand."""
    share, level = np.array(style.deck).T
    shares = np.linspace(0, 1, 33)
    top = np.interp(shares, share, level) * body.belt + between(rng, -0.02, 0.02)
    top = np.convolve(np.pad(top, 1, mode="edge"), [0.25, 0.5, 0.25], mode="valid")
    waist = 1 - between(rng, 0.10, 0.28) * np.abs(2 * shares - 1) ** between(rng, 4.0, 7.0)
    arch = body.wheel * 1.75
    split = min(arch, body.belt * 0.78)
    shell = _hull(body, shares, np.full(33, split * 0.96), np.maximum(top, split + 0.05), waist)
    gap = body.wheel * 1.22
    segments = [
        (-body.length / 2, body.rear_axle - gap),
        (body.rear_axle + gap, body.front_axle - gap),
        (body.front_axle + gap, body.length / 2),
    ]
    parts = [shell]
    for start, end in segments:
        places = np.linspace(start / body.length + 0.5, end / body.length + 0.5, 9)
        lifted = body.clearance + 0.12 * np.clip(np.abs(2 * places - 1) - 0.75, 0, 1)
        parts.append(_hull(body, places, lifted, np.full(9, split * 1.1), np.interp(places, shares, waist)))
    tunnel = (body.half * 1.15, split - body.clearance, body.length * 0.9)
    parts.append(box(tunnel, (0, (split + body.clearance) / 2 + 0.02, 0)))
    return parts


def _hull(body: Body, shares: np.ndarray, low: np.ndarray, high: np.ndarray, waist: np.ndarray) -> Part:
    """Loft of rounded rectangles along the car."""
    unit = ellipse(20, body.squareness)
    rings = np.empty((len(shares), len(unit), 3))
    rings[..., 0] = body.half * waist[:, None] * unit[:, 0]
    rings[..., 1] = (low + high)[:, None] / 2 + (high - low)[:, None] / 2 * unit[:, 1]
    rings[..., 2] = ((shares - 0.5) * body.length)[:, None]
    return loft(rings)


def _greenhouse(rng: np.random.Generator, body: Body, glass: tuple[float, float, float, float]) -> list[Part]:
    """Glass set in between pillars and a roof."""
    shift = between(rng, -0.015, 0.015)
    rear_low, rear_high, front_high, front_low = (body.along(share + shift) for share in glass)
    low, high = body.belt - 0.04, body.height
    wide, narrow = body.half * between(rng, 0.90, 0.96), body.half * between(rng, 0.70, 0.84)
    t = np.linspace(0, 1, 6)
    bend = t ** between(rng, 1.0, 1.5)
    rear, front = rear_low + (rear_high - rear_low) * bend, front_low + (front_high - front_low) * bend
    half = wide + (narrow - wide) * bend
    y = low + (high - 0.05 - low) * t
    parts = [_cabin(half * 0.97, y, rear + 0.03, front - 0.03)]
    parts.append(_roof(narrow, high, rear_high, front_high))
    thick = between(rng, 0.07, 0.11)
    inset = 0.025 * (front - rear) + 0.03  # to the rounded corners of the glass
    pillars = [np.stack([half * 0.94, y, end], axis=1) for end in (rear + inset, front - inset)]
    count = 2 if front_high - rear_high > 1.5 else 1
    for share in (np.arange(count) + 1) / (count + 1):
        pillars.append(np.stack([half * 0.985, y, rear + (front - rear) * (share + 0.04)], axis=1))
    return parts + with_mirror([tube(path, thick, square=True, up=(1, 0, 0)) for path in pillars])


def _cabin(half: np.ndarray, y: np.ndarray, rear: np.ndarray, front: np.ndarray) -> Part:
    unit = ellipse(20, 12.0)
    rings = np.empty((len(y), len(unit), 3))
    rings[..., 0] = half[:, None] * unit[:, 0]
    rings[..., 1] = y[:, None]
    rings[..., 2] = (rear + front)[:, None] / 2 - (front - rear)[:, None] / 2 * unit[:, 1]
    return loft(rings)


def _roof(half: float, top: float, rear: float, front: float) -> Part:
    size = (2 * half, 0.10, front - rear + 0.08)
    return rounded_box(size, (0, top - 0.05, (front + rear) / 2), 0.045, bulge=(0, 0.03, 0))


def _wheels(rng: np.random.Generator, body: Body) -> list[Part]:
    """Tyres with dished rims, standing out a little under arched lips."""
    radius, wide = body.wheel, between(rng, 0.19, 0.26)
    rim, dish = radius * between(rng, 0.58, 0.72), between(rng, 0.01, 0.04)
    outer = body.half * 0.985
    profile = [
        (rim, -wide),
        (radius * 0.94, -wide),
        (radius, -wide * 0.85),
        (radius, -wide * 0.15),
        (radius * 0.94, 0.0),
        (rim, 0.0),
        (rim * 0.94, -dish),
        (rim * 0.3, -dish * 0.6),
        (rim * 0.25, 0.0),
    ]
    tyre = lathe(profile, section=ellipse(20)).rotated("z", -90)
    parts = [tyre.moved((outer, radius, z)) for z in (body.rear_axle, body.front_axle)]
    if chance(rng, 0.7) and 2.3 * radius < 0.88 * body.belt:  # room under the bonnet for a lip
        angle = np.linspace(0.06 * np.pi, 0.94 * np.pi, 13)
        r, lip = radius * 1.17, between(rng, 0.06, 0.10)
        for axle in (body.rear_axle, body.front_axle):
            arc = np.stack(
                [np.full(13, outer - 0.01), radius + r * np.sin(angle), axle + r * np.cos(angle)], axis=1
            )
            parts.append(tube(arc, lip, up=(1, 0, 0)))
    return with_mirror(parts)


def _trim(rng: np.random.Generator, body: Body) -> list[Part]:
    """Bumpers, lamps and mirrors."""
    parts = []
    y = body.clearance + between(rng, 0.14, 0.24)
    if chance(rng, 0.7):
        for end in (1, -1):
            size = (body.half * between(rng, 1.6, 1.85), between(rng, 0.12, 0.2), 0.16)
            parts.append(rounded_box(size, (0, y, end * (body.length / 2 - 0.02)), 0.05))
    lamp = between(rng, 0.09, 0.13)
    spot = (body.half * 0.62, body.belt * 0.62, body.length / 2 - 0.02)
    if chance(rng, 0.5):
        lamps = [bar((spot[0], spot[1], spot[2] - 0.12), (spot[0], spot[1], spot[2] + 0.03), lamp * 1.7)]
    else:
        lamps = [rounded_box((lamp * 2.6, lamp, 0.14), spot, 0.03)]
    if chance(rng, 0.8):
        mirror_z = body.along(between(rng, 0.62, 0.68))
        lamps.append(rounded_box((0.2, 0.13, 0.09), (body.half + 0.07, body.belt + 0.06, mirror_z), 0.035))
    return parts + with_mirror(lamps)


def _cockpit(rng: np.random.Generator, body: Body) -> list[Part]:
    """Open car: windscreen frame, seats and a rim round the opening."""
    y, top = body.belt - 0.03, body.height
    foot, head, half = body.along(0.66), body.along(between(rng, 0.56, 0.6)), body.half * 0.82
    frame = [
        bar((half, y, foot), (half * 0.9, top, head), 0.08, square=True),
        rounded_box((0.46, 0.5, 0.16), (half * 0.48, y + 0.12, body.along(0.36)), 0.06).rotated(
            "x", -14, (0, y, body.along(0.36))
        ),
        bar((half * 1.02, y + 0.02, foot), (half * 1.02, y + 0.02, body.along(0.27)), 0.1),
    ]
    glass = bar((0, y, foot - 0.01), (0, top - 0.02, head), (2 * half, 0.03), square=True, up=(0, 0, 1))
    return [
        *with_mirror(frame),
        bar((-half * 0.9, top, head), (half * 0.9, top, head), 0.08, square=True),
        bar((-half, y + 0.02, body.along(0.27)), (half, y + 0.02, body.along(0.27)), 0.12),
        glass,
    ]


def _load_bed(body: Body) -> list[Part]:
    """Walls of an open bed behind the cab."""
    front, rear, wall = body.along(0.40), -body.length / 2 + 0.04, 0.08
    low, high = body.belt - 0.08, body.belt + 0.28
    side = box(
        (wall, high - low, front - rear), (body.half * 0.93 - wall / 2, (high + low) / 2, (front + rear) / 2)
    )
    gates = [
        box((body.half * 1.8, high - low, wall), (0, (high + low) / 2, z)) for z in (rear + wall / 2, front)
    ]
    return [*with_mirror([side]), *gates]


def _roof_rack(body: Body, style: Style) -> list[Part]:
    assert style.glass is not None
    rear, front = body.along(style.glass[1] + 0.04), body.along(style.glass[2] - 0.03)
    x, y = body.half * 0.62, body.height + 0.05
    rails = with_mirror([bar((x, y, rear), (x, y, front), 0.06, square=True)])
    bars = [bar((-x, y, z), (x, y, z), 0.06, square=True) for z in np.linspace(rear + 0.1, front - 0.1, 3)]
    feet = [box((0.06, 0.08, 0.06), (x, y - 0.03, z)) for z in (rear + 0.1, front - 0.1)]
    return [*rails, *bars, *with_mirror(feet)]


def _spoiler(rng: np.random.Generator, body: Body) -> list[Part]:
    z, base = -body.length / 2 + 0.18, body.belt * 0.96
    y = base + between(rng, 0.12, 0.26)
    wing = rounded_box((body.half * 1.75, 0.06, 0.28), (0, y, z), 0.025).rotated("x", 6, (0, y, z))
    return [
        wing,
        *with_mirror([box((0.07, y - base + 0.05, 0.16), (body.half * 0.6, (y + base) / 2 - 0.02, z))]),
    ]


def _spare_wheel(body: Body) -> Part:
    r = body.wheel * 0.95
    profile = [(r * 0.6, 0.0), (r, 0.02), (r, 0.18), (r * 0.6, 0.2)]
    wheel = lathe(profile, section=ellipse(20)).rotated("x", -90)
    return wheel.moved((0, body.belt * 0.85, -body.length / 2 + 0.02))
