"""Supports of seats and table tops: legs, pedestals, runners and frames, from the floor (y = 0) up."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from tetgan.shapes.builtin.draws import between, chance, pick, whole
from tetgan.shapes.builtin.parts import SQUARE, Part, bar, box, ellipse, lathe, sweep, tube, with_mirror

OVERLAP = 0.012  # metres a support reaches into what it carries, so that parts truly intersect


@dataclass(frozen=True)
class Footprint:
    """Room under a seat or top, in metres.

    `width` (x) and `depth` (z) are the outer extents of the legs, `height` that of the underside.
    """

    width: float
    depth: float
    height: float
    thickness: float

    def corners(self, inset: float = 0.5) -> Float[np.ndarray, "4 2"]:
        """(x, z) of leg axes, `inset` leg thicknesses inside the outer extents; front right first."""
        x = self.width / 2 - inset * self.thickness
        z = self.depth / 2 - inset * self.thickness
        return np.array([[x, z], [x, -z], [-x, -z], [-x, z]])


Support = Callable[[np.random.Generator, Footprint], list[Part]]


def straight_legs(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Four upright legs, perhaps tapered, perhaps joined by stretchers or an apron."""
    square = chance(rng, 0.6)
    taper = between(rng, 0.55, 0.85) if chance(rng, 0.4) else 1.0
    lines = _leg_lines(foot)
    parts = [
        bar(top, floor, foot.thickness, square=square, taper=taper, up=(0, 0, 1)) for top, floor in lines
    ]
    return parts + _bracing(rng, lines, foot)


def plain_legs(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Four short upright feet, square or round."""
    square = chance(rng, 0.6)
    taper = between(rng, 0.6, 1.0)
    return [
        bar(top, floor, foot.thickness, square=square, taper=taper, up=(0, 0, 1))
        for top, floor in _leg_lines(foot)
    ]


def splayed_legs(rng: np.random.Generator, foot: Footprint, *, bracing: bool = True) -> list[Part]:
    """Four legs leaning outwards and narrowing to the floor."""
    lines = _leg_lines(foot, splay=between(rng, 0.1, 0.2) * foot.height, inset=between(rng, 0.8, 1.6))
    taper = between(rng, 0.5, 0.9)
    parts = [bar(top, floor, foot.thickness * 1.1, taper=taper) for top, floor in lines]
    return parts + (_bracing(rng, lines, foot) if bracing and chance(rng, 0.5) else [])


def turned_legs(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Four lathe-turned legs with a block at the top."""
    r, h = foot.thickness / 2, foot.height
    beads = whole(rng, 1, 3)
    t = np.linspace(0, 1, 14)
    swell = between(rng, 0.15, 0.35)
    radius = r * (0.75 + swell * np.cos(2 * np.pi * beads * t) + 0.2 * t)
    profile = np.stack([radius, t * h * 0.82], axis=1)
    parts = []
    for x, z in foot.corners():
        parts.append(lathe(profile, centre=(x, 0, z), section=ellipse(10)))
        parts.append(box((2 * r, h * 0.2 + OVERLAP, 2 * r), (x, h * 0.9 + OVERLAP / 2, z)))
    return parts + _bracing(rng, _leg_lines(foot), foot)


def curved_legs(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Four sabre or cabriole legs."""
    s = np.linspace(0, 1, 11)
    sabre = chance(rng, 0.5)
    reach = between(rng, 0.04, 0.09)
    bend = reach * s**2 if sabre else reach * (np.sin(2.2 * np.pi * s) * 0.6 * (1 - s) + 0.5 * s**4)
    scale = foot.thickness * np.linspace(1.15, between(rng, 0.55, 0.75), 11)
    parts = []
    for x, z in foot.corners(0.7):
        path = np.stack(
            [x + np.sign(x) * bend * 0.7, (foot.height + OVERLAP) * (1 - s), z + np.sign(z) * bend], 1
        )
        parts.append(tube(path, scale, square=sabre, up=(0, 0, 1)))
    return parts


def hairpin_legs(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Four bent rods, each a narrow V."""
    rod = foot.thickness * between(rng, 0.4, 0.55)
    spread = between(rng, 0.05, 0.08)
    parts = []
    for x, z in foot.corners(0.6):
        top = foot.height + OVERLAP
        for dx, dz in ((-np.sign(x) * spread, 0.0), (0.0, -np.sign(z) * spread)):
            parts.append(bar((x + dx, top, z + dz), (x, 0, z), rod))
    return parts


def star_pedestal(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Gas-spring column on a star of four or five spokes, with castors or glides."""
    spokes, wheels = pick(rng, {5: 4, 4: 2}), chance(rng, 0.7)
    reach = max(foot.width, foot.depth) * between(rng, 0.48, 0.62)
    low = 0.06 if wheels else 0.0
    rise = between(rng, 0.02, 0.07)
    thick = foot.thickness * between(rng, 0.8, 1.0)
    hub = low + rise + thick / 2
    parts = [
        lathe(
            [
                [1.1 * thick, hub - thick],
                [1.1 * thick, hub],
                [0.8 * thick, hub + 0.1],
                [0.55 * thick, hub + 0.1],
                [0.55 * thick, foot.height - 0.04],
                [2.2 * thick, foot.height - 0.02],
                [2.2 * thick, foot.height + OVERLAP],
            ],
            section=ellipse(14),
        )
    ]
    start = between(rng, 0.0, 2 * np.pi / spokes) if chance(rng, 0.3) else np.pi / 2
    for angle in start + 2 * np.pi * np.arange(spokes) / spokes:
        direction = np.array([np.cos(angle), 0.0, np.sin(angle)])
        tip = direction * reach + [0, low + thick / 2, 0]
        parts.append(
            bar([0, hub - thick * 0.2, 0], tip, (thick, thick), square=True, taper=0.65, up=(0, 1, 0))
        )
        if wheels:
            side = np.array([-np.sin(angle), 0.0, np.cos(angle)])
            axle = direction * reach * 0.97 + [0, 0.03, 0]
            parts.append(bar(axle - side * 0.025, axle + side * 0.025, 0.06))
    return parts


def cross_foot(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Column on two crossed beams."""
    reach, thick = max(foot.width, foot.depth) * between(rng, 0.42, 0.5), foot.thickness
    column = bar(
        (0, thick * 0.3, 0),
        (0, foot.height + OVERLAP, 0),
        thick * between(rng, 1.0, 1.6),
        square=chance(rng, 0.5),
    )
    turn = pick(rng, {0.0: 1, 45.0: 1})
    beams = [
        box((2 * reach, thick * 0.8, thick), (0, thick * 0.4, 0)).rotated("y", turn + angle)
        for angle in (0, 90)
    ]
    return [column, *beams]


def curved_feet(count: int, reach: float, rise: float, thickness: float) -> list[Part]:
    """Feet arching down and out from a column, from height `rise` to the floor at radius `reach`."""
    t = np.linspace(0, 1, 8)
    radius = reach * t
    y = rise * (1 - t) ** 1.6 + thickness * (0.35 + 0.1 * t) + 0.15 * rise * np.sin(np.pi * t)
    foot = tube(
        np.stack([radius, y, np.zeros(8)], axis=1), thickness * np.linspace(1.1, 0.7, 8), up=(0, 0, 1)
    )
    return [foot.rotated("y", 45 + 360 * i / count) for i in range(count)]


def disc_pedestal(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Column on a round or square plate, bell or trumpet."""
    radius = max(foot.width, foot.depth) * between(rng, 0.36, 0.5)
    column = foot.thickness * between(rng, 0.5, 0.8)
    plate = between(rng, 0.02, 0.04)
    top = foot.height + OVERLAP
    plan = pick(rng, {"round": 3, "square": 1})
    section = ellipse(28) if plan == "round" else ellipse(28, 8.0)
    if chance(rng, 0.45):
        t = np.linspace(0, 1, 9)
        flow = column + (radius - column) * (1 - t) ** between(rng, 3.0, 6.0) + column * 0.9 * t**6
        return [
            lathe(np.stack([np.r_[radius, flow], np.r_[0, plate + t * (top - plate)]], 1), section=section)
        ]
    return [
        lathe([[radius, 0], [radius, plate], [radius * 0.9, plate + 0.012]], section=section),
        lathe([[column, plate / 2], [column, top - 0.03], [column * 2.2, top - 0.015], [column * 2.2, top]]),
    ]


def sled_runners(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """A closed loop on each side lying on the floor, joined by cross bars."""
    x, z = foot.corners()[0]
    rod = foot.thickness * between(rng, 0.65, 0.95)
    square = chance(rng, 0.4)
    low, high = rod / 2, foot.height + OVERLAP
    lean = between(rng, -0.03, 0.06)
    corners = [(high, z - lean), (low, z), (low, -z), (high, -z + lean)]
    path = _rounded_path(np.array([[x, y, depth] for y, depth in corners]), between(rng, 0.03, 0.09))
    parts = with_mirror([tube(path, rod, square=square, up=(1, 0, 0))])
    heights = [high - 0.03] + ([low] if chance(rng, 0.4) else [])
    for y in heights:
        for depth in (z * 0.9, -z * 0.9) if y > low else (-z * 0.9,):
            parts.append(bar((-x, y, depth), (x, y, depth), rod * 0.9, square=square))
    return parts


def rockers(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Four legs on two curved runners."""
    x, z = foot.corners()[0]
    length, sag = foot.depth * between(rng, 0.75, 0.95), between(rng, 0.06, 0.11)
    width = foot.thickness * between(rng, 0.8, 1.0)
    s = np.linspace(-1, 1, 13)
    runner = np.stack([np.full(13, x), width / 2 + sag * s**2, s * length - 0.04], axis=1)
    parts = with_mirror([sweep(runner, SQUARE * width / 2, up=(1, 0, 0))])
    for cx, cz in foot.corners():
        floor = np.interp(cz, runner[:, 2], runner[:, 1])
        parts.append(
            bar((cx, foot.height + OVERLAP, cz), (cx, floor, cz), foot.thickness, square=chance(rng, 0.5))
        )
    if chance(rng, 0.6):
        parts.append(bar((-x, foot.height * 0.5, z), (x, foot.height * 0.5, z), foot.thickness * 0.6))
    return parts


def cantilever(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """One bent tube: under the seat, down at the front, back along the floor and across."""
    x, z = foot.corners()[0]
    rod = foot.thickness * between(rng, 0.75, 1.0)
    low, high = rod / 2, foot.height - rod * 0.3
    bend = between(rng, 0.05, 0.12)
    side = np.array([[x, high, -z], [x, high, z], [x, low, z * between(rng, 0.85, 1.1)], [x, low, -z]])
    path = _rounded_path(side, bend)
    square = chance(rng, 0.3)
    return [
        *with_mirror([tube(path, rod, square=square, up=(1, 0, 0))]),
        bar((-x, low, -z), (x, low, -z), rod, square=square),
        bar((-x, high, -z), (x, high, -z), rod, square=square),
    ]


def side_panels(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Two upright boards, perhaps with a shelf or a rail between them."""
    thick = foot.thickness * between(rng, 0.7, 1.1)
    x = foot.width / 2 - thick / 2
    height = foot.height + OVERLAP
    parts = with_mirror([box((thick, height, foot.depth), (x, height / 2, 0))])
    y = foot.height * between(rng, 0.3, 0.8)
    if chance(rng, 0.6):
        parts.append(box((2 * x, 0.08, thick), (0, y, 0)))
    return parts


def plinth(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """A solid block, perhaps recessed from the floor."""
    recess = between(rng, 0.0, 0.08)
    height = foot.height + OVERLAP
    if chance(rng, 0.5):
        return [box((foot.width, height, foot.depth), (0, height / 2, 0))]
    return [
        box((foot.width, height - 0.06, foot.depth), (0, 0.06 + (height - 0.06) / 2, 0)),
        box((foot.width - 2 * recess, 0.08, foot.depth - 2 * recess), (0, 0.04, 0)),
    ]


def drum(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """A round block, straight or tapered."""
    low = between(rng, 0.8, 1.0)
    radius = min(foot.width, foot.depth) / 2
    return [lathe([(radius * low, 0.0), (radius, foot.height + OVERLAP)])]


def crossed_legs(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Folding X frames, one on each side (or one at the front and one at the back)."""
    x, z = foot.corners()[0]
    thick, high = foot.thickness * between(rng, 0.7, 0.9), foot.height + OVERLAP
    low = thick * 0.4  # the ends are cut square to the leg
    square = chance(rng, 0.5)
    pairs: list[tuple[tuple[float, float, float], tuple[float, float, float]]] = []
    if chance(rng, 0.6):
        for side in (x, -x):
            inner = side - np.sign(side) * thick
            pairs += [((side, high, z), (side, low, -z)), ((inner, high, -z), (inner, low, z))]
    else:
        for depth in (z, -z):
            inner = depth - np.sign(depth) * thick
            pairs += [((x, high, depth), (-x, low, depth)), ((-x, high, inner), (x, low, inner))]
    parts = [bar(top, floor, thick, square=square) for top, floor in pairs]
    parts += [bar((-x, thick, depth), (x, thick, depth), thick * 0.8) for depth in (z * 0.93, -z * 0.93)]
    return parts


def trestles(rng: np.random.Generator, foot: Footprint) -> list[Part]:
    """Two posts on feet, joined by a beam."""
    thick = foot.thickness * between(rng, 1.0, 1.3)
    x = foot.width / 2 * between(rng, 0.7, 0.9)
    high = foot.height + OVERLAP
    leg: list[Part] = [
        box((thick, thick * 0.8, foot.depth * 0.9), (x, thick * 0.4, 0)),
        box((thick, thick * 0.8, foot.depth * 0.8), (x, high - thick * 0.4, 0)),
    ]
    if chance(rng, 0.5):
        leg.append(box((thick, high - thick, thick * 1.6), (x, high / 2, 0)))
    else:
        z = foot.depth * 0.3
        leg += [
            bar((x, high, s * z * 0.4), (x, thick * 0.4, s * z), thick, square=True, up=(1, 0, 0))
            for s in (1, -1)
        ]
    return [
        *with_mirror(leg),
        box((2 * x, thick * 1.3, thick * 0.7), (0, foot.height * between(rng, 0.35, 0.6), 0)),
    ]


def _leg_lines(foot: Footprint, *, splay: float = 0.0, inset: float = 0.5) -> Float[np.ndarray, "4 2 3"]:
    """Axes of four legs from top to floor; `splay` is the outward reach at the floor in metres."""
    corners = foot.corners(inset)
    lines = np.zeros((4, 2, 3))
    lines[:, 0, [0, 2]] = corners
    lines[:, 1, [0, 2]] = corners + np.sign(corners) * splay
    lines[:, 0, 1] = foot.height + OVERLAP
    return lines


def _bracing(rng: np.random.Generator, lines: Float[np.ndarray, "4 2 3"], foot: Footprint) -> list[Part]:
    """Stretchers between the legs, of one pattern or none."""
    pattern = pick(rng, {"none": 4, "box": 2, "h": 2, "sides": 1, "cross": 0.7, "apron": 2})
    if pattern == "none":
        return []
    thick = foot.thickness * between(rng, 0.55, 0.8)
    if pattern == "apron":
        return _apron(lines, foot)
    down = 1 - between(rng, 0.25, 0.55)
    at = lines[:, 0] + (lines[:, 1] - lines[:, 0]) * down
    square = chance(rng, 0.4)
    if pattern == "cross":
        return [
            bar(at[0], at[2], thick, square=square, up=(0, 1, 0)),
            bar(at[1], at[3], thick, square=square, up=(0, 1, 0)),
        ]
    pairs = [(at[0], at[1]), (at[3], at[2])]
    if pattern == "box":
        pairs += [(at[0], at[3]), (at[1], at[2])]
    if pattern == "h":
        pairs.append(((at[0] + at[1]) / 2, (at[2] + at[3]) / 2))
    return [bar(a, b, thick, square=square, up=(0, 1, 0)) for a, b in pairs]


def _apron(lines: Float[np.ndarray, "4 2 3"], foot: Footprint) -> list[Part]:
    """Boards under the seat between the tops of the legs."""
    tall = min(0.09, foot.height * 0.2)
    tops = lines[:, 0] - [0, tall / 2 + OVERLAP / 2, 0]
    size = (foot.thickness * 0.6, tall)
    return [bar(tops[i], tops[(i + 1) % 4], size, square=True, up=(0, 1, 0)) for i in range(4)]


def _rounded_path(
    corners: Float[np.ndarray, "K 3"], radius: float, steps: int = 4
) -> Float[np.ndarray, "N 3"]:
    """Polyline whose inner corners are cut by quadratic arcs starting `radius` before each corner."""
    path = [corners[:1]]
    t = np.linspace(0, 1, steps)[:, None]
    for before, corner, after in zip(corners[:-2], corners[1:-1], corners[2:], strict=True):
        limit = 0.45 * min(np.linalg.norm(before - corner), np.linalg.norm(after - corner))
        reach = min(radius, float(limit))
        a = corner + reach * (before - corner) / np.linalg.norm(before - corner)
        b = corner + reach * (after - corner) / np.linalg.norm(after - corner)
        path.append((1 - t) ** 2 * a + 2 * t * (1 - t) * corner + t**2 * b)
    return np.concatenate([*path, corners[-1:]])
