"""Cheapest row of tets around a vertex that joins two pieces of one kind."""

import numpy as np
from jaxtyping import Float, Int

from tetgan.meshing.stars import Pieces

_LONGEST = 5  # rounds in which a bridge grows

_CHEAPEST = (
    1e-3  # of a step of a bridge: steps back, which cost less than nothing, must not go round in circles
)


def cheapest_bridges(
    pieces: Pieces, occupied: bool, cost: Float[np.ndarray, "T"]
) -> tuple[Int[np.ndarray, "R"], Int[np.ndarray, "R"]]:
    """For each vertex the cheapest row of tets that joins two of its pieces, both occupied or both empty.

    Each piece grows, tet by tet, over those that are cheapest to reach; where two that have grown meet at a
    face, the tets on the way there are a bridge.

    Returns:
        For each tet of a bridge the number of the bridge, ascending, and the tet's row among those of the
        pieces.
    """
    source = pieces.occupied == occupied
    step = np.where(source, 0.0, cost[pieces.tets].clip(min=_CHEAPEST))
    way, parent = np.where(source, 0.0, np.inf), np.arange(len(source))
    origin = pieces.label.copy()
    for side in np.tile(np.arange(pieces.beside.shape[1]), _LONGEST):
        before = pieces.beside[:, side]
        nearer = way[before] + step < way
        way[nearer] = (way[before] + step)[nearer]
        parent[nearer], origin[nearer] = before[nearer], origin[before][nearer]
    length = np.where(origin[:, None] != origin[pieces.beside], way[:, None] + way[pieces.beside], np.inf)
    side = length.argmin(axis=1)
    shortest = np.take_along_axis(length, side[:, None], axis=1)[:, 0]
    order = np.lexsort([shortest, pieces.place])
    ends = order[np.unique(pieces.place[order], return_index=True)[1]]
    ends = ends[np.isfinite(shortest[ends])]
    return _rows_to_source(pieces, np.stack([ends, pieces.beside[ends, side[ends]]]), parent)


def _rows_to_source(
    pieces: Pieces, ends: Int[np.ndarray, "2 N"], parent: Int[np.ndarray, "M"]
) -> tuple[Int[np.ndarray, "R"], Int[np.ndarray, "R"]]:
    """The tets on the way from both ends of each bridge to where the way begins, without the beginning."""
    number, rows = [], []
    for _ in range(_LONGEST * 3 + 1):
        on_way = parent[ends] != ends
        number.append(np.nonzero(on_way)[1])
        rows.append(ends[on_way])
        ends = parent[ends]
    found = np.unique(np.stack([np.concatenate(number), np.concatenate(rows)]), axis=1)
    return np.unique(found[0], return_inverse=True)[1], found[1]
