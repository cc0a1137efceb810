"""Vases: turned, lobed, faceted, square and twisted vessels with handles, bands and lids."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline, PchipInterpolator

from tetgan.shapes.builtin.draws import Real, between, chance, pick, pick_from, whole
from tetgan.shapes.builtin.parts import Part, ellipse, lathe, tube, with_mirror

Controls = list[tuple[Real, Real]]  # height share and radius over height, smooth in between

LEVELS = 33


@dataclass(frozen=True, eq=False)
class Body:
    """A vessel one unit tall: outer radius (N,) at heights (N,), and a unit section (S, 2) it scales."""

    height: Float[np.ndarray, "N"]
    radius: Float[np.ndarray, "N"]
    section: Float[np.ndarray, "S 2"]

    def at(self, height: float) -> float:
        return float(np.interp(height, self.height, self.radius))


def make_vase(rng: np.random.Generator) -> tuple[list[Part], str]:
    """One vase and its structural kind."""
    name, silhouette = pick_from(rng, SILHOUETTES)
    cut, section = _section(rng)
    body = Body(*_curve(rng, silhouette(rng)), section)
    wall = pick(rng, {"thick": 6, "sheet": 2, "solid": 1.2})
    vessel = _vessel(rng, body, wall)
    if cut in ("lobed", "square") and chance(rng, 0.35):
        cut += "-twisted"
        vessel = vessel.twisted(between(rng, 30.0, 140.0) * pick(rng, {1: 1, -1: 1}))
    extras = {
        extra: make(rng, body)
        for extra, make in EXTRAS.items()
        if chance(rng, _likelihood(extra, name, wall))
    }
    parts = [vessel, *(part for added in extras.values() for part in added)]
    return parts, f"{name}/{cut}/{'+'.join(extras) or 'plain'}-{wall}"


def _likelihood(extra: str, name: str, wall: str) -> float:
    """How often a silhouette gets a handle, bands or a lid."""
    if extra == "lid":
        return {"jar": 0.6, "ovoid": 0.15}.get(name, 0.0) if wall != "sheet" else 0.0
    if extra == "handles":
        return {"amphora": 0.85, "urn": 0.3, "ovoid": 0.25, "bottle": 0.3, "pear": 0.2}.get(name, 0.0)
    return {"jug": 0.9}.get(name, 0.0) if extra == "handle" else 0.2


# --- silhouettes --------------------------------------------------------------------------------------------


def _ovoid(rng: np.random.Generator) -> Controls:
    belly, at = between(rng, 0.24, 0.38), between(rng, 0.5, 0.72)
    neck = belly * between(rng, 0.35, 0.6)
    return [
        (0, belly * between(rng, 0.4, 0.65)),
        (at, belly),
        (0.9, neck),
        (1, neck * between(rng, 1.1, 1.5)),
    ]


def _bottle(rng: np.random.Generator) -> Controls:
    belly, neck = between(rng, 0.2, 0.33), between(rng, 0.055, 0.1)
    start = between(rng, 0.45, 0.65)
    return [
        (0, belly * between(rng, 0.5, 0.8)),
        (start * 0.45, belly),
        (start, neck * 1.2),
        (0.92, neck),
        (1, neck * between(rng, 1.2, 1.9)),
    ]


def _cylinder(rng: np.random.Generator) -> Controls:
    foot, lip = between(rng, 0.14, 0.3), between(rng, 0.85, 1.35)
    return [(0, foot), (0.5, foot * (1 + lip) / 2 * between(rng, 0.9, 1.1)), (1, foot * lip)]


def _trumpet(rng: np.random.Generator) -> Controls:
    slim = between(rng, 0.07, 0.12)
    return [
        (0, slim * between(rng, 1.6, 2.4)),
        (0.12, slim * 1.2),
        (0.4, slim),
        (0.75, slim * between(rng, 1.4, 1.9)),
        (1, slim * between(rng, 2.6, 3.6)),
    ]


def _gourd(rng: np.random.Generator) -> Controls:
    low, high = between(rng, 0.24, 0.34), between(rng, 0.13, 0.22)
    waist = high * between(rng, 0.4, 0.65)
    return [
        (0, low * 0.6),
        (0.26, low),
        (0.55, waist),
        (0.75, high),
        (0.94, waist * 0.9),
        (1, waist * between(rng, 1.1, 1.5)),
    ]


def _amphora(rng: np.random.Generator) -> Controls:
    belly, neck = between(rng, 0.22, 0.33), between(rng, 0.08, 0.13)
    return [
        (0, belly * 0.45),
        (0.04, belly * between(rng, 0.25, 0.4)),
        (between(rng, 0.45, 0.58), belly),
        (0.76, neck * 1.1),
        (0.93, neck),
        (1, neck * between(rng, 1.4, 1.9)),
    ]


def _urn(rng: np.random.Generator) -> Controls:
    bowl, stem = between(rng, 0.26, 0.4), between(rng, 0.08, 0.13)
    return [
        (0, bowl * between(rng, 0.55, 0.8)),
        (0.06, bowl * 0.5),
        (0.2, stem),
        (0.38, bowl * 0.75),
        (0.6, bowl * 0.95),
        (0.85, bowl * between(rng, 0.75, 0.95)),
        (1, bowl * between(rng, 1.05, 1.3)),
    ]


def _pear(rng: np.random.Generator) -> Controls:
    belly, neck = between(rng, 0.26, 0.38), between(rng, 0.09, 0.16)
    return [
        (0, belly * 0.65),
        (between(rng, 0.2, 0.32), belly),
        (0.7, neck),
        (1, neck * between(rng, 1.3, 2.1)),
    ]


def _bowl(rng: np.random.Generator) -> Controls:
    rim = between(rng, 0.45, 0.72)
    return [
        (0, rim * between(rng, 0.3, 0.5)),
        (0.3, rim * between(rng, 0.65, 0.95)),
        (0.7, rim),
        (1, rim * between(rng, 0.75, 1.15)),
    ]


def _globe(rng: np.random.Generator) -> Controls:
    belly, mouth = between(rng, 0.42, 0.55), between(rng, 0.4, 0.65)
    return [
        (0, belly * 0.5),
        (0.25, belly * 0.93),
        (0.48, belly),
        (0.75, belly * 0.9),
        (0.93, belly * mouth),
        (1, belly * mouth * between(rng, 1.0, 1.3)),
    ]


def _jar(rng: np.random.Generator) -> Controls:
    belly = between(rng, 0.28, 0.4)
    return [
        (0, belly * 0.72),
        (0.35, belly),
        (0.7, belly * between(rng, 0.92, 1.05)),
        (0.86, belly * 0.62),
        (1, belly * 0.55),
    ]


def _tulip(rng: np.random.Generator) -> Controls:
    cup = between(rng, 0.2, 0.32)
    return [
        (0, cup * 0.6),
        (0.3, cup * between(rng, 0.95, 1.1)),
        (0.65, cup * between(rng, 0.7, 0.8)),
        (1, cup * between(rng, 1.2, 1.6)),
    ]


def _cone(rng: np.random.Generator) -> Controls:
    rim, foot = between(rng, 0.22, 0.38), between(rng, 0.06, 0.12)
    return [
        (0, foot * between(rng, 1.4, 2.4)),
        (0.05, foot * 1.3),
        (0.14, foot),
        (0.55, (rim + foot) * 0.52),
        (1, rim),
    ]


SILHOUETTES: dict[str, tuple[Callable[[np.random.Generator], Controls], float]] = {
    "ovoid": (_ovoid, 3),
    "bottle": (_bottle, 3),
    "cylinder": (_cylinder, 2.5),
    "trumpet": (_trumpet, 2),
    "gourd": (_gourd, 1.5),
    "amphora": (_amphora, 3),
    "urn": (_urn, 2),
    "pear": (_pear, 3),
    "jug": (_pear, 1.5),
    "bowl": (_bowl, 1),
    "globe": (_globe, 1.5),
    "jar": (_jar, 1.5),
    "tulip": (_tulip, 2),
    "cone": (_cone, 1.5),
}


def _curve(
    rng: np.random.Generator, controls: Controls
) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N"]]:
    """Heights 0..1 and radii through the control points, perhaps rippled."""
    at, radius = np.array(controls, dtype=float).T
    height = np.linspace(0, 1, LEVELS)
    # A cubic spline swings out between many points; the monotone one does not.
    smooth = CubicSpline if len(at) <= 5 and chance(rng, 0.8) else PchipInterpolator
    curve = smooth(at, radius)(height)
    if chance(rng, 0.15):
        curve = curve * (1 + between(rng, 0.015, 0.04) * np.cos(2 * np.pi * whole(rng, 5, 9) * height))
    return height, np.maximum(curve, 0.045)


def _section(rng: np.random.Generator) -> tuple[str, Float[np.ndarray, "S 2"]]:
    """Horizontal cut of the body, of mean radius about one."""
    name = pick(rng, {"round": 8, "lobed": 2, "faceted": 1.5, "square": 1.5, "oval": 1})
    if name == "lobed":
        lobes = whole(rng, 5, 12)
        angle = np.arctan2(*ellipse(6 * lobes).T[::-1])
        return name, ellipse(6 * lobes) * (1 + between(rng, 0.04, 0.12) * np.cos(lobes * angle))[:, None]
    if name == "faceted":
        return name, ellipse(whole(rng, 5, 8))
    if name == "square":
        return name, ellipse(32, between(rng, 4.0, 10.0)) * 0.92
    if name == "oval":
        return name, ellipse(28) * np.array([between(rng, 1.1, 1.4), between(rng, 0.6, 0.85)])
    return name, ellipse(28)


# --- parts --------------------------------------------------------------------------------------------------


def _vessel(rng: np.random.Generator, body: Body, wall: str) -> Part:
    """The vessel: with an inside, as one open sheet, or filled to the brim."""
    outside = np.stack([body.radius, body.height], axis=1)
    if wall != "thick":
        return lathe(outside, section=body.section, cap_end=wall == "solid")
    thick, floor = np.minimum(between(rng, 0.035, 0.06), 0.6 * body.radius), between(rng, 0.05, 0.09)
    above = body.height > floor
    inside = np.stack([body.radius - thick, body.height], axis=1)[above][::-1]
    return lathe(np.concatenate([outside, inside]), section=body.section)


def _handles(rng: np.random.Generator, body: Body) -> list[Part]:
    """Two loops from the shoulder to the neck."""
    low, high = between(rng, 0.5, 0.65), between(rng, 0.84, 0.95)
    return with_mirror(
        [_loop(body, low, high, reach=between(rng, 0.06, 0.16), thick=between(rng, 0.045, 0.07))]
    )


def _handle(rng: np.random.Generator, body: Body) -> list[Part]:
    """One large loop."""
    low, high = between(rng, 0.25, 0.45), between(rng, 0.85, 0.95)
    return [_loop(body, low, high, reach=between(rng, 0.12, 0.2), thick=between(rng, 0.05, 0.075))]


def _loop(body: Body, low: float, high: float, *, reach: float, thick: float) -> Part:
    """Handle standing out `reach` from the line between its two roots in the wall."""
    t = np.linspace(0, 1, 13)
    side = body.section[:, 0].max()
    root, tip = side * body.at(low) - 0.02, side * body.at(high) - 0.02
    out = (reach + 0.4 * max(0.0, root - tip)) * np.sin(np.pi * t)
    y = low + (high - low) * t + 0.35 * reach * np.sin(np.pi * t) ** 2
    return tube(np.stack([root + (tip - root) * t + out, y, np.zeros(13)], axis=1), thick, up=(0, 0, 1))


def _bands(rng: np.random.Generator, body: Body) -> list[Part]:
    """Rings laid round the body."""
    bands = []
    for place in rng.uniform(0.15, 0.85, whole(rng, 1, 3)):
        inner, outer, half = body.at(place) * 0.9, body.at(place) + 0.02, between(rng, 0.01, 0.025)
        offsets = np.array([-1, -0.7, 0.7, 1]) * half
        profile = np.stack([[inner, outer, outer, inner], place + offsets], axis=1)
        bands.append(lathe(profile, section=body.section))
    return bands


def _lid(rng: np.random.Generator, body: Body) -> list[Part]:
    """A dome with a knob."""
    rise, wide = between(rng, 0.06, 0.16), body.at(1.0) * between(rng, 1.05, 1.25)
    t, s = np.linspace(0, 0.42 * np.pi, 6), np.linspace(0.15, np.pi - 0.15, 7)
    dome = np.stack([np.r_[wide, wide * np.cos(t)], np.r_[0.98, 1.02 + rise * np.sin(t)]], axis=1)
    knob = np.stack([0.05 * np.sin(s), 1.02 + rise + 0.03 - 0.05 * np.cos(s)], axis=1)
    return [lathe(dome, section=body.section), lathe(knob, section=ellipse(12))]


EXTRAS: dict[str, Callable[[np.random.Generator, Body], list[Part]]] = {
    "handles": _handles,
    "handle": _handle,
    "bands": _bands,
    "lid": _lid,
}
