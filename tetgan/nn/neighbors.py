"""Face adjacency of a grid and the tables that kernels gather by."""

from collections.abc import Callable
from typing import Literal, NamedTuple, TypeVar

import numpy as np
import torch
from jaxtyping import Int
from torch import Tensor, nn

SLOTS = 5  # the tet itself, then its neighbor across the face opposite each of its four vertices

Side = Literal["product", "adjoint"]
Made = TypeVar("Made")


class Bags(NamedTuple):
    """Sums of rows as `torch.embedding_bag` takes them: bag i is rows[starts[i]:starts[i + 1]]."""

    rows: Tensor
    starts: Tensor


class Chunk(NamedTuple):
    """The bags of the tets first … last − 1."""

    first: int
    last: int
    bags: Bags


class TetNeighbors(nn.Module):
    """Face adjacency of one grid, prepared for gathering in both directions.

    `neighbors` (T, 4) as in `TetGrid`: -1 stands for the outside, whose row is zero. Convolutions over
    `ordered` neighbors tell the four slots apart; over unordered ones they share a matrix among them, as
    a graph convolution does.

    Slot s of tet k gathers the row of its neighbor n(k, s) ("product"), or those of every tet whose
    slot s points at k ("adjoint"): the transposed matrix as a gather, so nothing is ever scattered.
    Tables are made when a kernel first asks for them.
    """

    table: Tensor

    def __init__(self, neighbors: Int[np.ndarray, "T 4"], *, ordered: bool = True) -> None:
        super().__init__()
        self.ordered = ordered
        self.tets = len(neighbors)
        # The grid determines it; it is not a weight to be saved.
        self.register_buffer("table", torch.from_numpy(neighbors.astype(np.int32)), persistent=False)
        self._made: dict[tuple[object, ...], object] = {}

    def slotwise(self, side: Side, size: int) -> list[Chunk]:
        """Chunks of `size` tets, each with the bags of slot 1, then of slot 2, …: (4, size) bags."""
        return self._once(("slotwise", side, size), lambda: self._chunks(side, size, slot_first=True))

    def tetwise(self, side: Side, size: int) -> list[Chunk]:
        """Chunks of `size` tets, each with the five bags of a tet side by side: (size, 5) bags."""
        return self._once(("tetwise", side, size), lambda: self._chunks(side, size, slot_first=False))

    def sums(self, side: Side, *, slot_first: bool) -> Bags:
        """One bag a tet: its five rows of a table (5, T) of rows (`slot_first`) or (T, 5)."""
        return self._once(("sums", side, slot_first), lambda: self._sums(side, slot_first))

    def padded(self, side: Side) -> Int[Tensor, "T 5 depth"]:
        """The rows of every bag, -1 where it has fewer than the longest."""
        return self._once(("padded", side), lambda: self._on_device(_padded(*self._bags(side))))

    def _once(self, key: tuple[object, ...], make: Callable[[], Made]) -> Made:
        key = (*key, self.table.device)
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]  # type: ignore[return-value]

    def _bags(self, side: Side) -> tuple[np.ndarray, np.ndarray]:
        return self._once(("bags", side), lambda: _bags(self.table.cpu().numpy(), side))

    def _chunks(self, side: Side, size: int, slot_first: bool) -> list[Chunk]:
        rows, starts = self._bags(side)
        chunks = []
        for first in range(0, self.tets, size):
            last = min(first + size, self.tets)
            bags = np.arange(first * SLOTS, last * SLOTS).reshape(-1, SLOTS)
            order = bags[:, 1:].T if slot_first else bags
            chunks.append(Chunk(first, last, self._put(*_select_bags(rows, starts, order.ravel()))))
        return chunks

    def _sums(self, side: Side, slot_first: bool) -> Bags:
        rows, starts = self._bags(side)
        slots = np.repeat(np.arange(len(starts) - 1) % SLOTS, np.diff(starts))
        places = slots * self.tets + rows if slot_first else rows * SLOTS + slots
        return self._put(places, starts[::SLOTS])

    def _put(self, rows: np.ndarray, starts: np.ndarray) -> Bags:
        return Bags(self._on_device(rows), self._on_device(starts))

    def _on_device(self, values: np.ndarray) -> Tensor:
        return torch.from_numpy(values.astype(np.int32)).to(self.table.device)


def _bags(
    neighbors: Int[np.ndarray, "T 4"], side: Side
) -> tuple[Int[np.ndarray, "R"], Int[np.ndarray, "5*T+1"]]:
    """Rows and starts of the bags (tet, slot), slot 0 the tet itself; rows ascend in a bag."""
    tets = len(neighbors)
    sources = np.column_stack([np.arange(tets), neighbors])
    row, slot = np.nonzero(sources >= 0)
    bag, rows = row * SLOTS + slot, sources[row, slot]
    if side == "adjoint":
        bag, rows = rows * SLOTS + slot, row
    order = np.lexsort((rows, bag))
    counts = np.bincount(bag, minlength=SLOTS * tets)
    return rows[order], np.concatenate([[0], np.cumsum(counts)])


def _select_bags(rows: np.ndarray, starts: np.ndarray, order: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The bags named by `order`, one after another."""
    lengths = (starts[1:] - starts[:-1])[order]
    ends = np.concatenate([[0], np.cumsum(lengths)])
    places = np.repeat(starts[order] - ends[:-1], lengths) + np.arange(ends[-1])
    return rows[places], ends


def _padded(rows: np.ndarray, starts: np.ndarray) -> Int[np.ndarray, "T 5 depth"]:
    lengths = np.diff(starts)
    filled = np.full((len(lengths), int(lengths.max(initial=1))), -1)
    filled[np.arange(filled.shape[1]) < lengths[:, None]] = rows
    return filled.reshape(-1, SLOTS, filled.shape[1])
