"""Closed parts and open sheets from which every built-in shape is assembled.

A part is wound outwards. Most are lofts: rings of equally many points joined in order, capped by fans, so a
ring must be star-shaped about its mean. Lengths are metres and angles degrees.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.builtin.draws import Real

Vector = Sequence[Real] | np.ndarray  # one point, direction or triple of sizes

Points = Sequence[Sequence[Real] | np.ndarray] | np.ndarray

Varying = Real | Sequence[Real] | np.ndarray  # one number, or one at each place

ROUND_SIDES = 12

ROUNDING_STEPS = 2

SQUARE: Float[np.ndarray, "4 2"] = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


@dataclass(frozen=True, eq=False)
class Part(TriangleMesh):
    """A triangle mesh that can be moved about."""

    def moved(self, offset: Vector) -> "Part":
        return Part(self.vertices + np.asarray(offset, dtype=float), self.faces)

    def rotated(self, axis: str, degrees: Real, about: Vector = (0.0, 0.0, 0.0)) -> "Part":
        """Turned counterclockwise about the line through `about` along a coordinate axis."""
        pivot = np.asarray(about, dtype=float)
        return Part((self.vertices - pivot) @ _rotation(axis, degrees).T + pivot, self.faces)

    def twisted(self, degrees: Real) -> "Part":
        """Turned about the y axis by an angle that grows with height, `degrees` a metre."""
        angle = np.radians(degrees) * self.vertices[:, 1]
        cosine, sine = np.cos(angle), np.sin(angle)
        x, y, z = self.vertices.T
        return Part(np.stack([x * cosine + z * sine, y, z * cosine - x * sine], axis=1), self.faces)

    def mirrored(self) -> "Part":
        """Reflected in the plane x = 0, still wound outwards."""
        return Part(self.vertices * np.array([-1.0, 1.0, 1.0]), self.faces[:, ::-1])


def with_mirror(parts: Sequence[Part]) -> list[Part]:
    """The parts and their reflections in x = 0."""
    return [*parts, *(part.mirrored() for part in parts)]


# --- outlines -----------------------------------------------------------------------------------------------


def ellipse(sides: int = ROUND_SIDES, exponent: Real = 2.0) -> Float[np.ndarray, "S 2"]:
    """Unit superellipse, counterclockwise: 2 is a circle, 4 a rounded square, larger is squarer."""
    angle = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.sign(circle) * np.abs(circle) ** (2 / exponent)


def outline(
    width: Real, depth: Real, *, exponent: Real | None = None, taper: Real = 1.0, sides: int = 28
) -> Float[np.ndarray, "S 2"]:
    """Plan of a seat or a table top in (x, z), centred, counterclockwise seen from above.

    Args:
        exponent: of the superellipse; None is a rectangle.
        taper: width at the back (-z) over width at the front.
    """
    unit = SQUARE if exponent is None else ellipse(sides, exponent)
    x, z = unit[:, 0] * width / 2, -unit[:, 1] * depth / 2
    shrink = 1 + (taper - 1) * (0.5 - z / depth)
    return np.stack([x * shrink, z], axis=1)


# --- parts --------------------------------------------------------------------------------------------------


def loft(rings: Float[np.ndarray, "N S 3"], *, cap_end: bool = True) -> Part:
    """Rings joined in order and capped; their points turn counterclockwise about the direction of travel."""
    count, sides = rings.shape[:2]
    start = np.arange(count - 1)[:, None] * sides
    here, turn = (start + np.arange(sides)).ravel(), (start + (np.arange(sides) + 1) % sides).ravel()
    vertices = [rings.reshape(-1, 3), rings[0].mean(axis=0, keepdims=True)]
    first, ahead = np.arange(sides), np.roll(np.arange(sides), -1)
    faces = [
        np.stack([here, turn, turn + sides], axis=1),
        np.stack([here, turn + sides, here + sides], axis=1),
        np.stack([np.full(sides, count * sides), ahead, first], axis=1),
    ]
    if cap_end:
        last = (count - 1) * sides
        vertices.append(rings[-1].mean(axis=0, keepdims=True))
        faces.append(np.stack([np.full(sides, count * sides + 1), first + last, ahead + last], axis=1))
    return Part(np.concatenate(vertices), np.concatenate(faces))


def box(size: Vector, centre: Vector) -> Part:
    """Axis-aligned box of the given edge lengths."""
    corners, faces = _cube_grid(2)
    half = np.asarray(size, dtype=float) / 2
    return Part((corners * 2 - 1) * half + np.asarray(centre, dtype=float), faces)


def rounded_box(size: Vector, centre: Vector, radius: Real, *, bulge: Vector = (0.0, 0.0, 0.0)) -> Part:
    """Box with rounded edges; `bulge` swells each pair of faces outwards, as stuffing does a cushion."""
    half = np.asarray(size, dtype=float) / 2
    radius = min(radius, 0.98 * half.min())
    index, faces = _cube_grid(2 * ROUNDING_STEPS + 3)
    corner = radius * np.arange(ROUNDING_STEPS + 1) / ROUNDING_STEPS
    ticks = [np.concatenate([-h + corner, [0.0], h - corner[::-1]]) for h in half]
    points = np.stack([ticks[axis][index[:, axis]] for axis in range(3)], axis=1)
    core = np.clip(points, radius - half, half - radius)
    outward = points - core
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    share = 1 - (core / np.maximum(half - radius, 1e-9)) ** 2
    swell = np.asarray(bulge, dtype=float) * outward
    swell *= np.stack(
        [share[:, 1] * share[:, 2], share[:, 0] * share[:, 2], share[:, 0] * share[:, 1]], axis=1
    )
    return Part(core + radius * outward + swell + np.asarray(centre, dtype=float), faces)


def slab(
    plan: Float[np.ndarray, "S 2"],
    bottom: Real,
    top: Real,
    *,
    edge: Real = 0.0,
    centre: Vector = (0.0, 0.0),
) -> Part:
    """Horizontal plate over a plan in (x, z), its rims bevelled by `edge` metres."""
    x, z = np.asarray(centre, dtype=float)
    heights, insets = [bottom, top], [0.0, 0.0]
    if edge > 0:
        edge = min(edge, 0.49 * (top - bottom))
        heights = [bottom, bottom + edge, top - edge, top - 0.3 * edge, top]
        insets = [edge, 0.0, 0.0, 0.3 * edge, edge]
    half = np.abs(plan).max(axis=0)
    rings = [
        np.stack(
            [plan[:, 0] * (1 - i / half[0]) + x, np.full(len(plan), y), plan[:, 1] * (1 - i / half[1]) + z], 1
        )
        for y, i in zip(heights, insets, strict=True)
    ]
    return loft(np.stack(rings))


def sweep(
    path: Points,
    section: Float[np.ndarray, "S 2"],
    scale: Varying = 1.0,
    *,
    up: Vector | None = None,
) -> Part:
    """A section carried along a path (N, 3), its second axis kept towards `up`.

    Args:
        scale: factor on the section; a number, (N,), or (N, 2) for its two axes.
        up: direction of the section's second axis; by default the coordinate axis most across the path.
    """
    path = np.asarray(path, dtype=float)
    tangent = np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    up = np.eye(3)[np.abs(tangent).max(axis=0).argmin()] if up is None else np.asarray(up, dtype=float)
    second = up - (tangent @ up)[:, None] * tangent
    second /= np.linalg.norm(second, axis=1, keepdims=True)
    first = np.cross(second, tangent)
    factors = np.asarray(scale, dtype=float)
    factors = np.broadcast_to(
        factors if factors.ndim == 2 else np.atleast_1d(factors)[:, None], (len(path), 2)
    )
    spread = section[None] * factors[:, None]
    rings = path[:, None] + spread[..., :1] * first[:, None] + spread[..., 1:] * second[:, None]
    return loft(rings)


def bar(
    start: Vector,
    end: Vector,
    thickness: Varying,
    *,
    square: bool = False,
    taper: Real = 1.0,
    up: Vector | None = None,
) -> Part:
    """Straight rod; `thickness` is full, one number or (first, second) axis; `taper` is end over start."""
    half = np.broadcast_to(np.asarray(thickness, dtype=float) / 2, (2,))
    section = SQUARE if square else ellipse()
    return sweep(np.array([start, end], dtype=float), section * half, np.array([1.0, taper]), up=up)


def tube(path: Points, thickness: Varying, *, square: bool = False, up: Vector | None = None) -> Part:
    """Rod along a smooth path; `thickness` is full, a number or (N,)."""
    return sweep(path, SQUARE if square else ellipse(), np.asarray(thickness, dtype=float) / 2, up=up)


def lathe(
    profile: Points,
    *,
    centre: Vector = (0.0, 0.0, 0.0),
    section: Float[np.ndarray, "S 2"] | None = None,
    cap_end: bool = True,
) -> Part:
    """Profile of (radius, height), bottom first, about the y axis; `section` replaces the unit circle."""
    radius, height = np.asarray(profile, dtype=float).T
    section = ellipse(24) if section is None else section
    rings = np.empty((len(radius), len(section), 3))
    rings[..., 0] = radius[:, None] * section[:, 0]
    rings[..., 1] = height[:, None]
    rings[..., 2] = -radius[:, None] * section[:, 1]
    return loft(rings + np.asarray(centre, dtype=float), cap_end=cap_end)


def panel(grid: Float[np.ndarray, "N M 3"], thickness: Real) -> Part:
    """Closed shell of a thickness about a surface sampled on a grid."""
    rows, columns = grid.shape[:2]
    normal = _grid_normals(grid) * thickness / 2
    front = _grid_faces(rows, columns)
    rim = _grid_rim(rows, columns)
    following, count = np.roll(rim, -1), rows * columns
    sides = np.concatenate(
        [np.stack([following, rim, rim + count], 1), np.stack([following, rim + count, following + count], 1)]
    )
    vertices = np.concatenate([(grid + normal).reshape(-1, 3), (grid - normal).reshape(-1, 3)])
    return Part(vertices, np.concatenate([front, front[:, ::-1] + count, sides]))


def sheet(grid: Float[np.ndarray, "N M 3"]) -> Part:
    """Open surface sampled on a grid: no thickness, as in many downloaded models."""
    return Part(grid.reshape(-1, 3).copy(), _grid_faces(*grid.shape[:2]))


# --- private ------------------------------------------------------------------------------------------------


def _rotation(axis: str, degrees: Real) -> Float[np.ndarray, "3 3"]:
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = np.eye(3)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = cosine, -sine, sine, cosine
    return matrix


@lru_cache(maxsize=8)
def _cube_grid(ticks: int) -> tuple[Int[np.ndarray, "V 3"], Int[np.ndarray, "F 3"]]:
    """Welded surface of a cube of `ticks` lattice points an edge: lattice indices and outward faces."""
    steps = np.arange(ticks)
    a, b = (grid.ravel() for grid in np.meshgrid(steps, steps, indexing="ij"))
    quads = _grid_faces(ticks, ticks)
    points: list[Int[np.ndarray, "Q 3"]] = []
    faces: list[Int[np.ndarray, "F 3"]] = []
    for axis in range(3):
        for side in (0, ticks - 1):
            plane = np.empty((ticks * ticks, 3), dtype=np.int64)
            plane[:, axis], plane[:, (axis + 1) % 3], plane[:, (axis + 2) % 3] = side, a, b
            faces.append((quads if side else quads[:, ::-1]) + sum(len(plane) for plane in points))
            points.append(plane)
    unique, index = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    return unique, index.reshape(-1)[np.concatenate(faces)]


def _grid_faces(rows: int, columns: int) -> Int[np.ndarray, "F 3"]:
    """Triangles of a grid, facing (along rows) x (along columns)."""
    here = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    down, right, both = here + columns, here + 1, here + columns + 1
    return np.concatenate([np.stack([here, down, both], 1), np.stack([here, both, right], 1)])


def _grid_rim(rows: int, columns: int) -> Int[np.ndarray, "R"]:
    """Border of a grid, in the direction its faces turn."""
    index = np.arange(rows * columns).reshape(rows, columns)
    return np.concatenate([index[:-1, 0], index[-1, :-1], index[:0:-1, -1], index[0, :0:-1]])


def _grid_normals(grid: Float[np.ndarray, "N M 3"]) -> Float[np.ndarray, "N M 3"]:
    normal = np.cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1))
    return normal / np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-12)
