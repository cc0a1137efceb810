"""Chamfer distance from generated shapes to the nearest training shape.

The same question is asked in two ways. A table asks it of whole sets, each shape with a few hundred points:
there all distances at once, in single precision and on a GPU, are quickest. A figure asks it of some samples
with every point: there trees are, and most candidates are dismissed before they are measured. Of 60
candidates the nearest takes 10 ms and 29 ms of a core with 512 points, 11.6 s and 0.13 s with 10,000.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from tetgan.evaluation.chamfer import (
    SurfaceSample,
    chamfer,
    chamfer_between,
    chamfer_selected,
    estimate_chamfer,
)

# A quarter of the points costs a sixteenth and orders shapes nearly as all of them do: the nearest is among
# this many candidates unless as many shapes are nearly as near, and then it makes no difference.
_PART = 4

_CANDIDATES = 24


# Points of each surface by which far candidates are dismissed, round by round, and how many standard errors
# a candidate must lie behind the best one to be so.
_PROBES = (256, 2048)

_ERRORS = 5.0


class Nearest(NamedTuple):
    """Of every shape: the Chamfer distance to the nearest training shape, and which one that is."""

    distance: Float[np.ndarray, "N"]
    shape: Int[np.ndarray, "N"]


def nearest_training(found: Float[np.ndarray, "N P 3"], training: Float[np.ndarray, "M Q 3"]) -> Nearest:
    """Nearest training shape of every shape; clouds hold their points in random order.

    The mean of the distances is the novelty of a set. A copy of a training shape scores what one mesh
    sampled twice does; shapes that were never seen, but come from the same source, what hold-out shapes do.
    Higher is not better: rubbish is novel.

    Training shapes are ordered by a quarter of the points; of the 24 nearest all points are measured.
    """
    rough = chamfer_between(found[:, : _few(found)], training[:, : _few(training)], "novelty")
    candidates = np.argsort(rough, axis=1)[:, :_CANDIDATES]
    distances = chamfer_selected(found, training, candidates, "nearest training shapes")
    best = distances.argmin(1)
    rows = np.arange(len(found))
    return Nearest(distances[rows, best], candidates[rows, best])


def _few(clouds: Float[np.ndarray, "N P 3"]) -> int:
    return max(1, clouds.shape[1] // _PART)


def find_nearest(
    shape: SurfaceSample | None, candidates: Sequence[SurfaceSample]
) -> tuple[int | None, float]:
    """The candidate at the smallest Chamfer distance, and that distance; none and nan for no shape.

    Most candidates are dismissed by a part of the points.
    """
    if shape is None or not len(candidates):
        return None, math.nan
    rows = list(range(len(candidates)))
    for probes in _PROBES:
        if len(rows) > 1 and probes < len(shape.points):
            estimates = [estimate_chamfer(shape, candidates[row], probes) for row in rows]
            middle, error = np.array(estimates).T
            near = middle - _ERRORS * error <= (middle + _ERRORS * error).min()
            rows = [row for row, kept in zip(rows, near, strict=True) if kept]
    distances = [chamfer(shape, candidates[row]) for row in rows]
    best = int(np.argmin(distances))
    return rows[best], distances[best]
