"""The one rule that splits a category."""

from collections.abc import Sequence

import numpy as np

from tetgan.shapes.entries import ShapeEntry
from tetgan.shapes.options import SplitOptions


def assign_splits(entries: Sequence[ShapeEntry], options: SplitOptions) -> dict[str, str]:
    """Id to 'train', 'validation' or 'holdout', for all listed shapes of a category.

    A source's own split stands. The others are permuted by the seed, and the first of every `validation`
    of them, rounded, validates. What repair makes of a shape plays no part, so every stage agrees.
    """
    splits = {entry.id: entry.split for entry in entries if entry.split is not None}
    free = sorted(entry.id for entry in entries if entry.split is None)
    order = np.random.default_rng(options.seed).permutation(len(free))
    validating = round(len(free) / options.validation)
    splits |= {
        free[position]: "validation" if rank < validating else "train" for rank, position in enumerate(order)
    }
    return splits
