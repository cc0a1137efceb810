"""Variety: mean Chamfer distance of the most similar pairs of a set."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.evaluation.chamfer import SurfaceSample, chamfer, estimate_chamfer
from tetgan.evaluation.options import VarietyOptions
from tetgan.progress import map_threads

# Queries of an estimate, and how many of its standard errors an exact distance may lie away from it. Six let
# fewer than one pair in a hundred million through.
_PROBES = 1000

_ERRORS = 6.0


def shapes_needed(options: VarietyOptions) -> int:
    """Fewest shapes from which a draw can be made."""
    if options.definition == "appendix":
        return options.pairs
    shapes = 2
    while shapes * (shapes - 1) // 2 < options.pairs:
        shapes += 1
    return shapes


def pool_size(options: VarietyOptions) -> int:
    """Shapes worth drawing from: enough for every pair of a draw to have its own two."""
    return 2 * options.pairs


def variety(
    samples: Sequence[SurfaceSample], options: VarietyOptions, rng: np.random.Generator, threads: int = 1
) -> Float[np.ndarray, "R"]:
    """Mean Chamfer distance of the closest pairs, once a repeat.

    Args:
        samples: one sample a generated shape.
        options: which pairs are drawn (see `VarietyOptions`) and how many count.
        rng: draws the pairs.
        threads: KD-tree queries run side by side.

    Raises:
        ValueError: fewer shapes than `shapes_needed`.
    """
    if len(samples) < shapes_needed(options):
        raise ValueError(f"variety needs {shapes_needed(options)} shapes, not {len(samples)}")
    draws = [_draw_pairs(len(samples), options, rng) for _ in range(options.repeats)]
    pairs, place = np.unique(np.concatenate(draws), axis=0, return_inverse=True)
    places = np.split(place.reshape(-1), options.repeats)
    probed = map_threads(
        lambda pair: estimate_chamfer(samples[pair[0]], samples[pair[1]], _PROBES), pairs, threads, "pairs"
    )
    estimate, error = np.array(probed).T
    measured = np.zeros(len(pairs), dtype=bool)
    for drawn in places:
        measured[drawn] |= _may_be_closest(estimate[drawn], error[drawn], options.closest)
    distances = np.full(len(pairs), np.inf)
    distances[measured] = map_threads(
        lambda pair: chamfer(samples[pair[0]], samples[pair[1]]), pairs[measured], threads, "closest pairs"
    )
    return np.array([np.sort(distances[drawn])[: options.closest].mean() for drawn in places])


def _draw_pairs(shapes: int, options: VarietyOptions, rng: np.random.Generator) -> Int[np.ndarray, "K 2"]:
    """Distinct unordered pairs of one repeat."""
    if options.definition == "appendix":
        chosen = np.sort(rng.choice(shapes, options.pairs, replace=False))
        return np.array(list(combinations(chosen, 2)))
    first, second = np.triu_indices(shapes, 1)
    chosen = rng.choice(len(first), options.pairs, replace=False)
    return np.stack([first[chosen], second[chosen]], axis=1)


def _may_be_closest(
    estimate: Float[np.ndarray, "K"], error: Float[np.ndarray, "K"], closest: int
) -> Bool[np.ndarray, "K"]:
    """Pairs that could be among the `closest`: only they are worth all their points."""
    bound = np.partition(estimate + _ERRORS * error, closest - 1)[closest - 1]
    return estimate - _ERRORS * error <= bound
