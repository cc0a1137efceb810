"""Shapes for the studies of a latent space, chosen by rule and from the fields alone.

No model has a say, so every model is shown on the same shapes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from tetgan.evaluation.seeds import named_rng
from tetgan.fields.field import Field
from tetgan.grids.grid import TetGrid

NEAREST = 8  # shapes most like A among which its B is looked for

MOST_SHAPES = 256  # shapes among which triples are looked for; more take long and make no better figure


class _Pair(NamedTuple):
    """Rows of A and B, the measures of `Triple`, and the box of their difference."""

    a: int
    b: int
    part: float
    kept: float
    box: Bool[np.ndarray, "T"]


class Triple(NamedTuple):
    """A and B are alike but for one part; C is like B where that part is, and unlike it elsewhere.

    Attributes:
        part: share of the union of A and B that one has far from the other.
        kept: share of the union that both have, outside the box around those differences.
    """

    a: str
    b: str
    c: str
    part: float = nan
    kept: float = nan


@dataclass(frozen=True, eq=False)
class Difference:
    """Tets in which two shapes differ by more than a shift of their surfaces.

    Attributes:
        added: tets of the first that lie outside the second, further than a threshold from its surface.
        removed: the same of the second.
        box: tets whose centroids lie in the box around both.
    """

    added: Bool[np.ndarray, "T"]
    removed: Bool[np.ndarray, "T"]
    box: Bool[np.ndarray, "T"]


def choose_pairs(ids: Sequence[str], count: int, seed: int) -> list[tuple[str, str]]:
    """Disjoint pairs, drawn at random: nothing else speaks for one pair or another."""
    order = named_rng(seed, "pairs").permutation(sorted(ids))
    return [(str(a), str(b)) for a, b in zip(order[0 : 2 * count : 2], order[1::2], strict=False)]


def difference(first: Field, second: Field, grid: TetGrid, threshold: float) -> Difference:
    """Tets in which two fields on a grid differ; `threshold` in cube sides."""
    added = _far_outside(first, second, threshold)
    removed = _far_outside(second, first, threshold)
    return Difference(added, removed, _box_around(added | removed, grid.centroids, threshold))


def choose_triples(fields: dict[str, Field], grid: TetGrid, count: int, threshold: float) -> list[Triple]:
    """The `count` clearest triples, no shape in two of them.

    For each shape A and each of the `NEAREST` shapes B most like it by occupancy, the part by which they
    differ is what lies further than `threshold` from the other. The clearer a pair, the larger the smaller
    one of `Triple.part` and `Triple.kept`: much differs in one place, and much is alike elsewhere. A is the
    one that has more there. C is, among the half of the other shapes that are least like B outside the box,
    the one most like B in it. Likeness is the volume of the intersection over that of the union. Ties go to
    the smaller id.

    Args:
        fields: by id; of more than `MOST_SHAPES`, the first by id count.

    Returns:
        Fewer triples where there are too few shapes.
    """
    ids = sorted(fields)[:MOST_SHAPES]
    if len(ids) < 3:
        return []
    occupancy = np.stack([fields[i].occupancy for i in ids])
    ranked = _ranked_pairs([fields[i] for i in ids], occupancy, grid, threshold)
    triples: list[Triple] = []
    used: set[int] = set()
    for pair in ranked:
        if len(triples) == count or len(ids) - len(used) < 3:
            break
        if not {pair.a, pair.b} & used:
            c = _third(pair, occupancy, grid.volumes, used)
            triples.append(Triple(ids[pair.a], ids[pair.b], ids[c], pair.part, pair.kept))
            used |= {pair.a, pair.b, c}
    return triples


def _ranked_pairs(
    fields: Sequence[Field], occupancy: Bool[np.ndarray, "N T"], grid: TetGrid, threshold: float
) -> list[_Pair]:
    """Pairs from the clearest down."""
    ranked = []
    for a, b in _near_pairs(occupancy, grid.volumes):
        found = difference(fields[a], fields[b], grid, threshold)
        added, removed = (float(grid.volumes[part].sum()) for part in (found.added, found.removed))
        both, either = fields[a].occupancy & fields[b].occupancy, fields[a].occupancy | fields[b].occupancy
        together = float(grid.volumes[either].sum())
        if added + removed > 0:
            kept = float(grid.volumes[both & ~found.box].sum()) / together
            one, other = (a, b) if added >= removed else (b, a)
            ranked.append(_Pair(one, other, (added + removed) / together, kept, found.box))
    return sorted(ranked, key=lambda pair: (-min(pair.part, pair.kept), pair.a, pair.b))


def _near_pairs(occupancy: Bool[np.ndarray, "N T"], volumes: Float[np.ndarray, "T"]) -> list[tuple[int, int]]:
    """Each shape with the `NEAREST` most like it; every pair once, the smaller row first."""
    likeness = _likeness(occupancy, occupancy, volumes)
    np.fill_diagonal(likeness, -1)
    nearest = np.argsort(-likeness, axis=1, kind="stable")[:, : min(NEAREST, len(occupancy) - 1)]
    return sorted({(min(a, b), max(a, b)) for a, row in enumerate(nearest.tolist()) for b in row})


def _third(
    pair: _Pair,
    occupancy: Bool[np.ndarray, "N T"],
    volumes: Float[np.ndarray, "T"],
    used: set[int],
) -> int:
    """Row of C for a pair."""
    free = np.array([row for row in range(len(occupancy)) if row not in used | {pair.a, pair.b}])
    outside, inside = (
        _likeness(occupancy[[pair.b]], occupancy[free], volumes * part)[0] for part in (~pair.box, pair.box)
    )
    unlike = np.sort(np.argsort(outside, kind="stable")[: (len(free) + 1) // 2])
    return int(free[unlike[np.argmax(inside[unlike])]])


def _likeness(
    first: Bool[np.ndarray, "N T"], second: Bool[np.ndarray, "M T"], volumes: Float[np.ndarray, "T"]
) -> Float[np.ndarray, "N M"]:
    """Volume of the intersection over that of the union; 1 where both are empty."""
    weighed = first * volumes.astype(np.float32)
    both = weighed @ second.T.astype(np.float32)
    sizes = second.astype(np.float32) @ volumes.astype(np.float32)
    either = weighed.sum(axis=1)[:, None] + sizes - both
    return np.where(either > 0, both / np.maximum(either, np.finfo(np.float32).tiny), 1.0).astype(np.float64)


def _far_outside(first: Field, second: Field, threshold: float) -> Bool[np.ndarray, "T"]:
    """Tets of the first that the second does not have anywhere near."""
    outside = first.occupancy & ~second.occupancy
    return outside & (np.linalg.norm(second.displacement, axis=1) > threshold)


def _box_around(
    tets: Bool[np.ndarray, "T"], centroids: Float[np.ndarray, "T 3"], room: float
) -> Bool[np.ndarray, "T"]:
    """Tets in the bounding box of some, with some room on every side."""
    if not tets.any():
        return np.zeros_like(tets)
    low, high = centroids[tets].min(axis=0) - room, centroids[tets].max(axis=0) + room
    return ((centroids >= low) & (centroids <= high)).all(axis=1)
