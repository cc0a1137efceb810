"""Smallest change of occupancy that makes the boundary manifold."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.meshing.bridges import cheapest_bridges
from tetgan.meshing.collared_grid import CollaredGrid
from tetgan.meshing.stars import Pieces

_AT_ONCE = 2000  # changes weighed together: bounds the memory on noise, where every vertex is at fault


class _Changes(NamedTuple):
    """Sets of tets that might change sides, each a way to mend something.

    Attributes:
        change: (M,) number of the set, ascending.
        tets: (M,) its tets.
    """

    change: Int[np.ndarray, "M"]
    tets: Int[np.ndarray, "M"]

    @property
    def number(self) -> int:
        return int(self.change[-1]) + 1 if len(self.change) else 0

    def only(self, wanted: Bool[np.ndarray, "C"]) -> "_Changes":
        """Some of the sets, numbered anew."""
        kept = wanted[self.change]
        return _Changes((np.cumsum(wanted) - 1)[self.change[kept]], self.tets[kept])


class _Effect(NamedTuple):
    """What changes would do to the vertices of their tets.

    Attributes:
        change, vertex: (N,) the two, by change; defect: (N,) of the vertex afterwards.
        gain: (C,) sum of the defects that each change would mend, less those it would make.
    """

    change: Int[np.ndarray, "N"]
    vertex: Int[np.ndarray, "N"]
    defect: Int[np.ndarray, "N"]
    gain: Int[np.ndarray, "C"]


def boundary_defects(occupancy: Bool[np.ndarray, "T"], ambient: CollaredGrid) -> Int[np.ndarray, "V"]:
    """Defect of each vertex; 0 everywhere exactly when the boundary is manifold.

    Around a vertex the tets cut a small sphere into triangles. The boundary meets the sphere in one closed
    curve, so has one fan there, exactly when the occupied triangles hang together side by side, and the empty
    ones as well (Jordan); and a surface with one fan at each vertex has two faces at each edge. The defect is
    the number of pieces beyond one of each.
    """
    defect = np.zeros(len(ambient.vertices), dtype=np.int64)
    vertices = mixed_vertices(occupancy, ambient)
    defect[vertices] = ambient.around_vertices.pieces(vertices, None, occupancy).defects(len(vertices))
    return defect


def make_manifold(
    occupancy: Bool[np.ndarray, "T"],
    ambient: CollaredGrid,
    cost: Float[np.ndarray, "T"],
    where: Bool[np.ndarray, "V"] | None = None,
) -> Bool[np.ndarray, "T"]:
    """Fill and empty tets until the boundary is a manifold, at little cost.

    Around each vertex and edge at fault every piece of tets, occupied or empty, might change sides, and so
    might the tets of a bridge between two pieces of one kind (`cheapest_bridges`). Of the changes that lower
    the sum of the defects, the cheapest for what they mend are made, as many at once as have no vertex in
    common, until none is left; each round lowers the sum, so this ends. Where defects remain, tets around
    them are emptied for good (`_tets_to_empty`), and it goes on: at worst until all are.
    At last tets that need not have changed, seen from the end, change back.

    Args:
        occupancy: none of the collar.
        cost: of changing each tet; changing it back refunds it.
        where: vertices to mend; None: all.
    """
    original, occupied, cost = occupancy, occupancy.copy(), cost.copy()
    where = np.ones(len(ambient.vertices), dtype=bool) if where is None else where
    defect = boundary_defects(occupied, ambient)
    while len(faulty := np.flatnonzero(defect * where)):
        signed = np.where((occupied == original) | np.isinf(cost), cost, -cost)
        changes = _cheapest_first(_possible_changes(occupied, faulty, ambient, signed), signed)
        if not _improve(changes, occupied, defect, ambient, signed):
            emptied = _tets_to_empty(faulty, occupied, ambient, cost)
            occupied[emptied], cost[emptied] = False, np.inf
            defect = boundary_defects(occupied, ambient)
    return _change_back(occupied, original, ambient, cost, defect=defect, where=where)


def mixed_vertices(occupancy: Bool[np.ndarray, "T"], ambient: CollaredGrid) -> Int[np.ndarray, "N"]:
    """Vertices with tets of both kinds around them."""
    touched = np.zeros((2, len(ambient.vertices)), dtype=bool)
    touched[0, ambient.tets[occupancy]] = True
    touched[1, ambient.tets[~occupancy]] = True
    return np.flatnonzero(touched.all(axis=0))


def _possible_changes(
    occupied: Bool[np.ndarray, "T"],
    vertices: Int[np.ndarray, "N"],
    ambient: CollaredGrid,
    cost: Float[np.ndarray, "T"],
) -> _Changes:
    """The pieces around vertices at fault, and around edges there with four boundary faces; and bridges."""
    at_vertices = ambient.around_vertices.pieces(vertices, None, occupied)
    own = np.unique(at_vertices.tets)
    edges = np.unique(ambient.edges_of_tets[own[own < ambient.grid_tets]])
    at_edges = ambient.around_edges.pieces(edges, None, occupied)
    pinched = at_edges.counts(len(edges))[:, 1] > 1
    return _together(
        _as_changes(at_vertices.label, at_vertices.tets),
        _as_changes(at_edges.label, at_edges.tets).only(pinched[at_edges.piece_place]),
        _as_bridges(at_vertices, True, cost),
        _as_bridges(at_vertices, False, cost),
    )


def _as_bridges(pieces: Pieces, occupied: bool, cost: Float[np.ndarray, "T"]) -> _Changes:
    number, rows = cheapest_bridges(pieces, occupied, cost)
    return _Changes(number, pieces.tets[rows])


def _together(*sets: _Changes) -> _Changes:
    first = np.cumsum([0, *(each.number for each in sets)])
    return _Changes(
        np.concatenate([each.change + start for each, start in zip(sets, first, strict=False)]),
        np.concatenate([each.tets for each in sets]),
    )


def _as_changes(number: Int[np.ndarray, "M"], tets: Int[np.ndarray, "M"]) -> _Changes:
    order = np.argsort(number, kind="stable")
    return _Changes(number[order], tets[order])


def _cheapest_first(changes: _Changes, cost: Float[np.ndarray, "T"]) -> _Changes:
    """The changes that leave the collar alone, in the order of their cost."""
    weights = np.bincount(changes.change, cost[changes.tets], minlength=changes.number)
    allowed = np.isfinite(weights)
    rank = np.empty(len(weights), dtype=np.int64)
    rank[np.argsort(weights, kind="stable")] = np.arange(len(weights))
    numbers = rank[changes.change]
    order = np.argsort(numbers, kind="stable")
    return _Changes(numbers[order], changes.tets[order]).only(allowed[np.argsort(rank)])


def _improve(
    changes: _Changes,
    occupied: Bool[np.ndarray, "T"],
    defect: Int[np.ndarray, "V"],
    ambient: CollaredGrid,
    cost: Float[np.ndarray, "T"],
) -> bool:
    """Make the best of the changes, in place; whether there was any that lowers the sum of the defects."""
    for start in range(0, changes.number, _AT_ONCE):
        numbers = np.arange(changes.number)
        some = changes.only((numbers >= start) & (numbers < start + _AT_ONCE))
        effect = _effect(some, occupied, defect, ambient)
        price = np.bincount(some.change, cost[some.tets], minlength=some.number)
        gains = effect.gain > 0
        price = np.divide(price, effect.gain, out=np.full(len(price), np.inf), where=gains)
        chosen = _independent(effect, price, gains)
        if chosen.any():
            occupied[some.tets[chosen[some.change]]] ^= True
            made = chosen[effect.change]
            defect[effect.vertex[made]] = effect.defect[made]
            return True
    return False


def _effect(
    changes: _Changes, occupied: Bool[np.ndarray, "T"], defect: Int[np.ndarray, "V"], ambient: CollaredGrid
) -> _Effect:
    """Defects of all vertices of the tets of each change, were it made."""
    base = len(ambient.vertices)
    touched = np.unique(changes.change[:, None] * base + ambient.tets[changes.tets])
    change, vertex = np.divmod(touched, base)
    corners, place = ambient.around_vertices.corners(vertex)
    tets = corners // 4
    flipped = _contains(changes, change[place], tets, len(ambient.tets))
    pieces = ambient.around_vertices.pieces(vertex, occupied[tets] ^ flipped, occupied)
    after = pieces.defects(len(vertex))
    gain = np.bincount(change, defect[vertex] - after, minlength=changes.number)
    return _Effect(change, vertex, after, np.rint(gain).astype(np.int64))


def _contains(
    changes: _Changes, change: Int[np.ndarray, "N"], tets: Int[np.ndarray, "N"], base: int
) -> Bool[np.ndarray, "N"]:
    keys = np.sort(changes.change * base + changes.tets)
    wanted = change * base + tets
    return keys[np.searchsorted(keys, wanted).clip(max=len(keys) - 1)] == wanted


def _independent(
    effect: _Effect, price: Float[np.ndarray, "C"], wanted: Bool[np.ndarray, "C"]
) -> Bool[np.ndarray, "C"]:
    """Wanted changes, each with the lowest price of all that share a vertex with it."""
    rank = np.empty(len(price), dtype=np.int64)
    rank[np.argsort(price, kind="stable")] = np.arange(len(price))
    rank[~wanted] = len(price)
    best = np.full(effect.vertex.max(initial=0) + 1, len(price), dtype=np.int64)
    np.minimum.at(best, effect.vertex, rank[effect.change])
    beaten = np.zeros(len(price), dtype=bool)
    beaten[effect.change[best[effect.vertex] < rank[effect.change]]] = True
    return wanted & ~beaten


def _change_back(
    occupied: Bool[np.ndarray, "T"],
    original: Bool[np.ndarray, "T"],
    ambient: CollaredGrid,
    cost: Float[np.ndarray, "T"],
    *,
    defect: Int[np.ndarray, "V"],
    where: Bool[np.ndarray, "V"],
) -> Bool[np.ndarray, "T"]:
    """With single tets as they were before, the costliest first, where that makes no new defect."""
    occupied, defect = occupied.copy(), defect.copy()
    while True:
        tets = np.flatnonzero((occupied != original) & np.isfinite(cost))
        effect = _effect(_Changes(np.arange(len(tets)), tets), occupied, defect, ambient)
        harm = np.bincount(effect.change, effect.defect * where[effect.vertex], minlength=len(tets))
        chosen = _independent(effect, -cost[tets], (effect.gain >= 0) & (harm == 0))
        if not chosen.any():
            return occupied
        occupied[tets[chosen]] ^= True
        made = chosen[effect.change]
        defect[effect.vertex[made]] = effect.defect[made]


def _tets_to_empty(
    vertices: Int[np.ndarray, "N"],
    occupied: Bool[np.ndarray, "T"],
    ambient: CollaredGrid,
    cost: Float[np.ndarray, "T"],
) -> Int[np.ndarray, "M"]:
    """The occupied pieces around each vertex but the costliest, or all if there is one only: never none."""
    pieces = ambient.around_vertices.pieces(vertices, None, occupied)
    costs = np.where(pieces.piece_occupied, np.bincount(pieces.label, cost[pieces.tets]), -1)
    order = np.lexsort([costs, pieces.piece_place])
    costliest = order[np.searchsorted(pieces.piece_place[order], np.arange(len(vertices)), side="right") - 1]
    emptied = pieces.piece_occupied.copy()
    emptied[costliest[pieces.counts(len(vertices))[:, 1] > 1]] = False
    return np.unique(pieces.tets[emptied[pieces.label]])
