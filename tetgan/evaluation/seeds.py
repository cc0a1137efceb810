"""Random choices seeded by their purpose, independent of the order of calls."""

import hashlib
from collections.abc import Collection

import numpy as np


def named_seed(seed: int, *names: str) -> int:
    """A seed of its own for every name, the same on every platform."""
    text = "\0".join([str(seed), *names])
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "big")


def named_rng(seed: int, *names: str) -> np.random.Generator:
    """A generator of its own for every name."""
    return np.random.default_rng(named_seed(seed, *names))


def choose(names: Collection[str], most: int, seed: int, purpose: str) -> list[str]:
    """At most `most` of the names, drawn without replacement, whatever their order."""
    order = named_rng(seed, "choose", purpose).permutation(sorted(names))
    return [str(name) for name in order[:most]]
