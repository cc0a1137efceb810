"""Random choices that depend on what they are for, not on the order in which they are made."""

import hashlib

import numpy as np


def named_seed(seed: int, *names: str) -> int:
    """A seed of its own for every name, the same on every platform."""
    text = "\0".join([str(seed), *names])
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "big")


def named_rng(seed: int, *names: str) -> np.random.Generator:
    """A generator of its own for every name."""
    return np.random.default_rng(named_seed(seed, *names))
