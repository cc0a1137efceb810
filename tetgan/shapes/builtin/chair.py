"""Chairs: composed of seat, support, back and arms, or one of the easy chairs."""

from dataclasses import dataclass, replace

import numpy as np

from tetgan.shapes.builtin import arms, backs, supports
from tetgan.shapes.builtin import easy_chairs as easy
from tetgan.shapes.builtin.draws import between, chance, pick, pick_from, whole
from tetgan.shapes.builtin.parts import Part, box, outline, panel, rounded_box, slab, with_mirror

BACKS: dict[str, tuple[backs.Back, float]] = {
    "solid": (backs.solid_back, 3),
    "padded": (backs.padded_back, 3),
    "slatted": (backs.slatted_back, 3),
    "spindle": (backs.spindle_back, 2.5),
    "ladder": (backs.ladder_back, 3),
    "open": (backs.open_back, 1.5),
    "cross": (backs.cross_back, 1.5),
    "splat": (backs.splat_back, 2),
    "hoop": (backs.hoop_back, 1.5),
    "medallion": (backs.medallion_back, 1.5),
    "lattice": (backs.lattice_back, 1),
    "caned": (backs.caned_back, 1.5),
    "floating": (backs.floating_back, 2),
}

SUPPORTS: dict[str, tuple[supports.Support, float]] = {
    "straight-legs": (supports.straight_legs, 7),
    "splayed-legs": (supports.splayed_legs, 4),
    "turned-legs": (supports.turned_legs, 2),
    "curved-legs": (supports.curved_legs, 2.5),
    "star-pedestal": (supports.star_pedestal, 3),
    "disc-pedestal": (supports.disc_pedestal, 1.5),
    "sled": (supports.sled_runners, 2),
    "rockers": (supports.rockers, 1),
    "cantilever": (supports.cantilever, 2),
    "side-panels": (supports.side_panels, 1),
    "plinth": (supports.plinth, 0.7),
    "crossed-legs": (supports.crossed_legs, 1),
}

ARMS = {
    "post-arms": arms.post_arms,
    "loop-arms": arms.loop_arms,
    "pad-arms": arms.pad_arms,
    "wall-arms": arms.wall_arms,
}


@dataclass(frozen=True)
class Frame:
    """Main sizes of a chair in metres; `seat` is the height of the seat's top.

    The seat's plan is a superellipse of `exponent` (None: a rectangle), at the rear `taper` as wide as at
    the front.
    """

    width: float
    depth: float
    seat: float
    cushion: float
    back: float
    leg: float
    exponent: float | None = None
    taper: float = 1.0

    @property
    def reach(self) -> float:
        """Where the diagonal meets the plan, as a share of half its width: legs and posts stand within."""
        return 1.0 if self.exponent is None else 2 ** (-1 / self.exponent)


def make_chair(rng: np.random.Generator) -> tuple[list[Part], str]:
    """One chair and its structural kind."""
    kinds = {
        _composed: 70,
        _bar_chair: 3,
        easy.shell_chair: 7,
        easy.club_chair: 8,
        easy.tub_chair: 4,
        easy.plank_chair: 3,
        easy.reclined_chair: 3,
    }
    return pick(rng, kinds)(rng)


def _frame(rng: np.random.Generator) -> Frame:
    width = between(rng, 0.40, 0.60)
    rounded = chance(rng, 0.35)
    return Frame(
        width=width,
        depth=width * between(rng, 0.85, 1.12),
        seat=between(rng, 0.40, 0.52),
        cushion=between(rng, 0.04, 0.10),
        back=between(rng, 0.36, 0.66),
        leg=between(rng, 0.042, 0.075),
        exponent=between(rng, 2.6, 8.0) if rounded else None,
        taper=between(rng, 0.82, 1.0) if rounded else 1.0,
    )


def _composed(rng: np.random.Generator) -> tuple[list[Part], str]:
    frame = _frame(rng)
    support, _ = pick_from(rng, SUPPORTS)
    back, _ = pick_from(rng, BACKS)
    if support == "star-pedestal" and chance(rng, 0.7):
        back = pick(rng, {"padded": 3, "solid": 1, "floating": 1})
    arm = _pick_arms(rng, support)
    plane = _back_plane(rng, frame)
    parts = [*_seat(rng, frame), *_support(rng, frame, support), *_back(rng, frame, plane, back)]
    if arm != "no-arms":
        parts += ARMS[arm](rng, _arm_room(rng, frame, plane))
    return parts, f"{back}/{support}/{arm}"


def _pick_arms(rng: np.random.Generator, support: str) -> str:
    if support == "star-pedestal":
        return pick(rng, {"no-arms": 3, "pad-arms": 6, "loop-arms": 2})
    return pick(rng, {"no-arms": 11, "post-arms": 4, "loop-arms": 2, "wall-arms": 1})


def _support(rng: np.random.Generator, frame: Frame, kind: str) -> list[Part]:
    width = frame.width * frame.reach * (1 + frame.taper) / 2
    foot = supports.Footprint(width, frame.depth * frame.reach, frame.seat - frame.cushion, frame.leg)
    return SUPPORTS[kind][0](rng, foot)


def _back_plane(rng: np.random.Generator, frame: Frame) -> backs.BackPlane:
    return backs.BackPlane(
        width=(frame.width * frame.reach * frame.taper - frame.leg) * between(rng, 0.88, 1.0),
        height=frame.back,
        seat=frame.seat,
        z=-frame.depth / 2 * frame.reach + frame.leg * 0.5,
        tilt=between(rng, 2.0, 14.0),
        sway=between(rng, -0.02, 0.06),
        bow=between(rng, 0.02, 0.09) if chance(rng, 0.65) else 0.0,
        flare=between(rng, 0.85, 1.15),
    )


def _back(rng: np.random.Generator, frame: Frame, plane: backs.BackPlane, kind: str) -> list[Part]:
    return BACKS[kind][0](rng, plane, frame.leg * between(rng, 0.7, 1.0))


def _arm_room(rng: np.random.Generator, frame: Frame, plane: backs.BackPlane) -> arms.ArmRoom:
    rise = min(between(rng, 0.17, 0.26), frame.back * 0.7)
    joint = plane.point(1, rise / plane.height)
    return arms.ArmRoom(
        x=frame.width / 2 * frame.reach - frame.leg * between(rng, 0.1, 0.5),
        seat=frame.seat,
        height=frame.seat + rise,
        back=float(joint[2]),
        front=frame.depth / 2 * frame.reach,
        thickness=frame.leg * between(rng, 0.75, 1.0),
        rear=float(joint[0]),
    )


def _seat(rng: np.random.Generator, frame: Frame) -> list[Part]:
    """Plate, cushion on a plate, boards, or a hollowed panel."""
    if frame.exponent is None:
        kind = pick(rng, {_board: 3, _cushioned_seat: 3, _saddle: 1.5, _slatted_seat: 1})
        return kind(rng, frame)
    plan = outline(frame.width, frame.depth, exponent=frame.exponent, taper=frame.taper)
    under, edge = frame.seat - frame.cushion, frame.cushion * between(rng, 0.1, 0.45)
    if chance(rng, 0.6):
        return [slab(plan, under, frame.seat, edge=edge)]
    lift = frame.cushion * between(rng, 0.3, 0.8)
    return [
        slab(plan, under, frame.seat, edge=0.1 * edge),
        slab(plan * 0.96, frame.seat - 0.02, frame.seat + lift, edge=lift * 0.4),
    ]


def _board(_: np.random.Generator, frame: Frame) -> list[Part]:
    return [box((frame.width, frame.cushion, frame.depth), (0, frame.seat - frame.cushion / 2, 0))]


def _cushioned_seat(rng: np.random.Generator, frame: Frame) -> list[Part]:
    puff = frame.cushion * between(rng, 0.8, 1.6)
    size = (frame.width * 0.97, puff, frame.depth * 0.97)
    pad = rounded_box(size, (0, frame.seat + puff / 4, 0), puff * 0.4, bulge=(0, 0.015, 0))
    return [*_board(rng, frame), pad]


def _saddle(rng: np.random.Generator, frame: Frame) -> list[Part]:
    """A panel hollowed for the sitter."""
    u, v = np.meshgrid(np.linspace(-1, 1, 11), np.linspace(-1, 1, 11), indexing="ij")
    dip = between(rng, 0.02, 0.05) * (1 - u**2) * (1 - (v * 0.8 - 0.1) ** 2)
    middle = frame.seat - frame.cushion / 2 - dip
    return [panel(np.stack([u * frame.width / 2, middle, -v * frame.depth / 2], axis=-1), frame.cushion)]


def _slatted_seat(rng: np.random.Generator, frame: Frame) -> list[Part]:
    """Boards from side to side on two bearers."""
    count = whole(rng, 4, 6)
    pitch, thick = frame.depth / count, frame.cushion * 0.6
    parts = [
        box(
            (frame.width, thick, pitch * 0.75),
            (0, frame.seat - thick / 2, -frame.depth / 2 + (i + 0.5) * pitch),
        )
        for i in range(count)
    ]
    bearer = box(
        (frame.leg, frame.cushion, frame.depth),
        (frame.width / 2 - frame.leg / 2, frame.seat - frame.cushion / 2 - 0.005, 0),
    )
    return parts + with_mirror([bearer])


def _bar_chair(rng: np.random.Generator) -> tuple[list[Part], str]:
    """A high seat with a low back."""
    width = between(rng, 0.36, 0.44)
    frame = replace(
        _frame(rng),
        width=width,
        depth=width,
        seat=between(rng, 0.62, 0.76),
        back=between(rng, 0.22, 0.36),
        leg=between(rng, 0.04, 0.055),
    )
    back = pick(rng, {"solid": 2, "open": 1, "slatted": 1, "ladder": 1, "padded": 1})
    support = pick(rng, {"splayed-legs": 3, "straight-legs": 3, "disc-pedestal": 2})
    parts = [
        *_seat(rng, frame),
        *_support(rng, frame, support),
        *_back(rng, frame, _back_plane(rng, frame), back),
    ]
    return parts, f"bar-{back}/{support}/no-arms"
