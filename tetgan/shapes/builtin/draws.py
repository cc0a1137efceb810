"""Small random decisions, so that a category's module reads as a description of its shapes."""

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

Real = float | int

Choice = TypeVar("Choice")

Thing = TypeVar("Thing")


def chance(rng: np.random.Generator, probability: float) -> bool:
    return bool(rng.random() < probability)


def between(rng: np.random.Generator, low: Real, high: Real) -> float:
    return float(rng.uniform(low, high))


def whole(rng: np.random.Generator, low: int, high: int) -> int:
    """An integer of low..high, both included."""
    return int(rng.integers(low, high + 1))


def pick(rng: np.random.Generator, weights: Mapping[Choice, Real]) -> Choice:
    """One key, by weight."""
    choices = list(weights)
    shares = np.array([weights[choice] for choice in choices], dtype=float)
    return choices[int(np.searchsorted(np.cumsum(shares) / shares.sum(), rng.random(), side="right"))]


def pick_from(rng: np.random.Generator, table: Mapping[str, tuple[Thing, Real]]) -> tuple[str, Thing]:
    """One entry of a table of name: (thing, weight)."""
    name = pick(rng, {name: weight for name, (_, weight) in table.items()})
    return name, table[name][0]
