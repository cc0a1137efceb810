"""How far generated shapes lie from what the model has seen."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from tetgan.evaluation.pairwise import chamfer_between


class Nearest(NamedTuple):
    """Of every shape: the Chamfer distance to the nearest training shape, and which one that is."""

    distance: Float[np.ndarray, "N"]
    index: Int[np.ndarray, "N"]


def nearest_training(found: Float[np.ndarray, "N P 3"], training: Float[np.ndarray, "M Q 3"]) -> Nearest:
    """Nearest training shape of every shape.

    The mean of the distances is the novelty of a set. A copy of a training shape scores what one mesh
    sampled twice does; shapes that were never seen, but come from the same source, what hold-out shapes do.
    Higher is not better: rubbish is novel.
    """
    distances = chamfer_between(found, training, "novelty")
    index = distances.argmin(1)
    return Nearest(distances[np.arange(len(found)), index], index)
