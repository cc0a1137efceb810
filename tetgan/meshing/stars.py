"""Tets around vertices or edges, and the pieces they fall into."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int

from tetgan.geometry.components import label_components


class Pieces(NamedTuple):
    """Tets around some simplices, sorted into pieces: occupied or empty, joined face to face.

    Attributes:
        tets: (M,) the tets around the first simplex, then those around the second, ...
        place: (M,) number of the simplex in the question.
        beside: (M, S) numbers, among these, of the tets across the faces that hold the simplex.
        occupied: (M,) whether a tet counts as occupied; label: (M,) number of its piece.
        piece_place: (P,) number of the simplex that a piece lies around.
        piece_occupied: (P,) whether a piece is occupied.
    """

    tets: Int[np.ndarray, "M"]
    place: Int[np.ndarray, "M"]
    beside: Int[np.ndarray, "M S"]
    occupied: Bool[np.ndarray, "M"]
    label: Int[np.ndarray, "M"]
    piece_place: Int[np.ndarray, "P"]
    piece_occupied: Bool[np.ndarray, "P"]

    def counts(self, places: int) -> Int[np.ndarray, "places 2"]:
        """Number of empty and of occupied pieces around each simplex."""
        both = np.bincount(2 * self.piece_place + self.piece_occupied, minlength=2 * places)
        return both.reshape(places, 2)

    def defects(self, places: int) -> Int[np.ndarray, "places"]:
        """Number of pieces around each simplex beyond one of each kind."""
        return (self.counts(places) - 1).clip(min=0).sum(axis=1)


class Stars:
    """Tets around each simplex (vertex or edge), and which of them share a face there.

    A corner is one simplex of one tet; corner c of tet t has the number C·t + c.
    """

    def __init__(
        self,
        members: Int[np.ndarray, "T C"],
        neighbors: Int[np.ndarray, "T 4"],
        faces: Int[np.ndarray, "C S"],
    ) -> None:
        """Args:
        members: the simplices of each tet.
        neighbors: of the tets; slot s is the one across the face opposite local vertex s.
        faces: for each corner the slots of the faces that hold its simplex.
        """
        self._members, self._neighbors, self._faces = members, neighbors, faces
        self._order = np.argsort(members.ravel(), kind="stable")
        self._count = np.bincount(members.ravel())
        self._start = np.concatenate([[0], np.cumsum(self._count)])

    def corners(self, simplices: Int[np.ndarray, "N"]) -> tuple[Int[np.ndarray, "M"], Int[np.ndarray, "M"]]:
        """The corners at some simplices, and for each its place in `simplices`."""
        count = self._count[simplices]
        place = np.repeat(np.arange(len(simplices)), count)
        first = np.cumsum(count) - count
        offset = np.arange(len(place)) - first[place]
        return self._order[self._start[simplices][place] + offset], place

    def pieces(
        self,
        simplices: Int[np.ndarray, "N"],
        occupied: Bool[np.ndarray, "M"] | None,
        occupancy: Bool[np.ndarray, "T"],
    ) -> Pieces:
        """Around each simplex, its tets sorted into pieces.

        Args:
            simplices: not those of the outside of the collar; may repeat.
            occupied: whether each of `corners(simplices)` counts as occupied; None: as `occupancy` has it.
        """
        corners, place = self.corners(simplices)
        tets = corners // self._members.shape[1]
        if occupied is None:
            occupied = occupancy[tets]
        first = np.searchsorted(place, np.arange(len(simplices)))
        beside = first[place][:, None] + self._rank[self._beside[corners]]
        rows, slots = np.nonzero(occupied[:, None] == occupied[beside])
        label = label_components(rows, beside[rows, slots], len(corners))
        some = np.zeros(label.max(initial=-1) + 1, dtype=np.int64)
        some[label] = np.arange(len(label))
        return Pieces(tets, place, beside, occupied, label, place[some], occupied[some])

    @cached_property
    def _rank(self) -> Int[np.ndarray, "K"]:
        """Position of each corner among those of its simplex."""
        rank = np.empty(self._members.size, dtype=np.int64)
        rank[self._order] = np.arange(self._members.size) - np.repeat(self._start[:-1], self._count)
        return rank

    @cached_property
    def _beside(self) -> Int[np.ndarray, "K S"]:
        """Corners of the same simplex across the faces that hold it; meaningless at the outside."""
        corners = self._members.shape[1]
        beside = np.empty((*self._members.shape, self._faces.shape[1]), dtype=np.int64)
        for corner, slots in enumerate(self._faces):
            for side, slot in enumerate(slots):
                tets = self._neighbors[:, slot]
                same = self._members[tets] == self._members[:, corner, None]
                beside[:, corner, side] = corners * tets + same.argmax(axis=1)
        return beside.reshape(-1, self._faces.shape[1])
