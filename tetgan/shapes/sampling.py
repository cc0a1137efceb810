"""Points on surfaces: of a clean mesh, and of the outside of a raw one."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.rays import Visibility
from tetgan.geometry.triangles import area_normals

# Directions tried on each side of a point, over its half sphere: neighbours are about 18 degrees apart, so
# what can be seen only through a chink narrower than that may count as inside.
_DIRECTIONS = 64


# Start of a ray above its point, in longest sides: clear of its own face in float32, below any real wall.
_LIFT = 1e-4

_ROUNDS = 8

Points = Float[np.ndarray, "P 3"]


def sample_surface(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], count: int, seed: int | Sequence[int]
) -> tuple[Points, Points]:
    """Area-uniform points and the unit normals of their faces.

    Raises:
        ValueError: no face has an area.
    """
    return _draw(vertices[faces], count, np.random.default_rng(seed))


def sample_exterior(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], count: int, seed: int | Sequence[int]
) -> tuple[Points, Points]:
    """Area-uniform points of what can be seen from outside, and unit normals towards the viewer.

    A point is kept when a ray from just above or below it, along one of 64 spread directions, leaves the
    shape. Which way a face points, whether it is there twice, and what lies hidden inside play no part; both
    sides of an open sheet are its outside.

    Raises:
        ValueError: no face has an area, or too little of the surface can be seen.
    """
    rng = np.random.default_rng(seed)
    triangles = vertices[_distinct_faces(vertices, faces)]
    visibility = Visibility(triangles)
    lift = _LIFT * np.ptp(vertices, axis=0).max()
    points, normals, found = [], [], 0
    for _ in range(_ROUNDS):
        drawn, upward = _draw(triangles, max(3 * (count - found) // 2, 256), rng)
        above = visibility.sees_out_on_side(drawn + lift * upward, upward, _DIRECTIONS)
        below = ~above
        below[below] = visibility.sees_out_on_side(
            (drawn - lift * upward)[below], -upward[below], _DIRECTIONS
        )
        seen = above | below
        points.append(drawn[seen])
        normals.append(np.where(above, 1.0, -1.0)[seen, None] * upward[seen])
        found += int(seen.sum())
        if found >= count:
            return np.concatenate(points)[:count], np.concatenate(normals)[:count]
    raise ValueError(f"only {found} of {count} points can be seen from outside")


def _draw(
    triangles: Float[np.ndarray, "F 3 3"], count: int, rng: np.random.Generator
) -> tuple[Points, Points]:
    """Area-uniform points on triangles and their unit normals."""
    crosses = area_normals(triangles)
    doubled_areas = np.linalg.norm(crosses, axis=1)
    total = np.cumsum(doubled_areas)
    if not len(total) or not total[-1] > 0:
        raise ValueError("no face has an area")
    # side="right" passes over faces without an area, whose cumulative sums repeat.
    chosen = np.searchsorted(total, rng.random(count) * total[-1], side="right")
    first, second = rng.random((2, count, 1))
    # Folding the unit square along its diagonal keeps the draw uniform on the triangle.
    outside = first + second > 1
    first, second = np.where(outside, 1 - first, first), np.where(outside, 1 - second, second)
    corner, b, c = triangles[chosen].transpose(1, 0, 2)
    return corner + first * (b - corner) + second * (c - corner), crosses[chosen] / doubled_areas[
        chosen, None
    ]


def _distinct_faces(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]
) -> Int[np.ndarray, "G 3"]:
    """One of each set of faces with the same corners: a doubled face would be sampled twice as densely."""
    size = max(np.ptp(vertices, axis=0).max(), np.finfo(float).tiny)
    _, place = np.unique(np.round(vertices / size, 7), axis=0, return_inverse=True)
    _, first = np.unique(np.sort(place.reshape(-1)[faces], axis=1), axis=0, return_index=True)
    return faces[np.sort(first)]
