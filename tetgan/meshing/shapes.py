"""Volumes and least angles of many tets at once."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float


class TetShapes(NamedTuple):
    """Six times the volume of each tet, and the cosine of its least dihedral angle."""

    volume: Float[np.ndarray, "*N"]
    cosine: Float[np.ndarray, "*N"]


def tet_shapes(points: Float[np.ndarray, "4 3 *N"]) -> TetShapes:
    """Of tets whose corners are given, coordinate by coordinate: much the fastest layout."""
    a, b, c = points[1:] - points[:1]
    one, two, three = _cross(b, c), _cross(c, a), _cross(a, b)
    normals = (-(one + two + three), one, two, three)  # inward, as long as twice the face's area
    lengths = [np.sqrt(np.maximum(_dot(normal, normal), np.finfo(float).tiny)) for normal in normals]
    cosine = np.full(points.shape[2:], -1.0)
    for i, j in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)):
        between = _dot(normals[i], normals[j])
        between /= lengths[i] * lengths[j]
        np.maximum(cosine, np.negative(between, out=between), out=cosine)
    return TetShapes(_dot(a, one), cosine)


def six_volumes(points: Float[np.ndarray, "4 3 *N"]) -> Float[np.ndarray, "*N"]:
    """The volume of `tet_shapes` alone."""
    a, b, c = points[1:] - points[:1]
    return _dot(a, _cross(b, c))


def _cross(a: Float[np.ndarray, "3 *N"], b: Float[np.ndarray, "3 *N"]) -> Float[np.ndarray, "3 *N"]:
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        np.multiply(a[j], b[k], out=out[i])
        out[i] -= a[k] * b[j]
    return out


def _dot(a: Float[np.ndarray, "3 *N"], b: Float[np.ndarray, "3 *N"]) -> Float[np.ndarray, "*N"]:
    total = a[0] * b[0]
    total += a[1] * b[1]
    total += a[2] * b[2]
    return total
