"""How far generated shapes lie from what the model has seen."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from tetgan.evaluation.pairwise import chamfer_between, chamfer_selected

# A quarter of the points costs a sixteenth and orders shapes nearly as all of them do: the nearest is among
# so many candidates unless that many shapes are nearly as near, and then it makes no difference.
_PART = 4
_CANDIDATES = 24


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
