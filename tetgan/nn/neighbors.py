"""Face adjacency of a grid and the tables that kernels gather by."""

from collections.abc import Callable
from typing import Literal, NamedTuple, TypeVar

import numpy as np
import torch
from jaxtyping import Int
from torch import Tensor, nn

SLOTS = 5  # the tet itself, then its neighbor across the face opposite each of its four vertices

FEW = 1 << 19  # bags whose starts are counted anew for each size of chunks, rather than each time

KEPT = 12  # tables of sides and batches, the size of a narrow layer's features each

Side = Literal["product", "adjoint"]

Made = TypeVar("Made")


class Bags(NamedTuple):
    """Sums of rows as `torch.embedding_bag` takes them: bag i is rows[starts[i]:starts[i + 1]]."""

    rows: Tensor
    starts: Tensor


class Chunk(NamedTuple):
    """Some of the bags: their rows, and where each starts among all rows, `before` of which come first."""

    rows: Tensor
    starts: Tensor
    before: int

    def bags(self) -> Bags:
        return Bags(self.rows, self.starts - self.before if self.before > 0 else self.starts)


class Gathers:
    """The five bags of each tet, shape by shape, of the rows of features (T·B, C): (T, B, 5) bags."""

    def __init__(self, bags: Bags, batch: int) -> None:
        self.bags, self.batch = bags, batch
        self._chunks: dict[int, list[Chunk]] = {}
        self._sums: dict[tuple[int, bool], Bags] = {}

    def chunks(self, size: int) -> list[Chunk]:
        """The bags of `size` tets at a time. They share one table, so every size costs next to nothing."""
        if size not in self._chunks:
            rows, starts = self.bags
            step = size * self.batch * SLOTS
            parts = [starts[first : first + step + 1] for first in range(0, len(starts) - 1, step)]
            ends = [(int(part[0]), int(part[-1])) for part in parts]
            if len(starts) <= FEW:
                parts = [part - first for part, (first, _) in zip(parts, ends, strict=True)]
            self._chunks[size] = [
                Chunk(rows[first:last], part, 0 if len(starts) <= FEW else first)
                for part, (first, last) in zip(parts, ends, strict=True)
            ]
        return self._chunks[size]

    def sums(self, width: int, *, and_last: bool = False) -> Bags:
        """One bag a tet and shape: five rows of a table (T·B, `width`), which holds a row for each slot.

        With `and_last` also the first row behind the table, after the others.
        """
        if (width, and_last) not in self._sums:
            rows, starts = self.bags
            slots = torch.arange(len(starts) - 1, dtype=rows.dtype, device=rows.device) % SLOTS
            places = rows * width + slots.repeat_interleave(starts.diff())
            sums = Bags(places, starts[::SLOTS].contiguous())
            self._sums[width, and_last] = _with_last(sums, width) if and_last else sums
        return self._sums[width, and_last]


def _with_last(sums: Bags, width: int) -> Bags:
    """Each bag with one row more: the one behind the table."""
    bags = torch.arange(len(sums.starts), dtype=sums.rows.dtype, device=sums.rows.device)
    rows = sums.rows.new_full((len(sums.rows) + len(bags) - 1,), width * (len(bags) - 1))
    kept = torch.arange(len(sums.rows), device=bags.device) + bags[:-1].repeat_interleave(sums.starts.diff())
    rows[kept] = sums.rows
    return Bags(rows, sums.starts + bags)


class TetNeighbors(nn.Module):
    """Face adjacency of one grid, prepared for gathering in both directions.

    `neighbors` (T, 4) as in `TetGrid`: -1 is the outside, whose row is zero. Convolutions over
    `ordered` neighbors have a matrix per slot; over unordered ones they share a matrix among them, as
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
        self._gathers: dict[torch.device, dict[tuple[Side, int], Gathers]] = {}

    def gathers(self, side: Side, batch: int) -> Gathers:
        """The tables for `batch` shapes; those of the last few sizes of a batch are kept."""
        made = self._gathers.setdefault(self.table.device, {})
        if (side, batch) not in made:
            if len(made) >= KEPT:
                del made[next(iter(made))]
            rows, starts = _of_shapes(*self._bags(side), batch)
            made[side, batch] = Gathers(Bags(self._on_device(rows), self._on_device(starts)), batch)
        return made[side, batch]

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


def _of_shapes(rows: np.ndarray, starts: np.ndarray, batch: int) -> tuple[np.ndarray, np.ndarray]:
    """From bags (T, 5) of tets to bags (T, B, 5) of the rows (T·B, C) of their shapes."""
    lengths = np.diff(starts).reshape(-1, 1, SLOTS).repeat(batch, axis=1)
    ends = np.concatenate([[0], np.cumsum(lengths)])
    firsts = np.broadcast_to(starts[:-1].reshape(-1, 1, SLOTS), lengths.shape)
    places = np.repeat(firsts.ravel() - ends[:-1], lengths.ravel()) + np.arange(ends[-1])
    shapes = np.broadcast_to(np.arange(batch)[:, None], lengths.shape)
    return rows[places] * batch + np.repeat(shapes.ravel(), lengths.ravel()), ends


def _padded(rows: np.ndarray, starts: np.ndarray) -> Int[np.ndarray, "T 5 depth"]:
    lengths = np.diff(starts)
    filled = np.full((len(lengths), int(lengths.max(initial=1))), -1)
    filled[np.arange(filled.shape[1]) < lengths[:, None]] = rows
    return filled.reshape(-1, SLOTS, filled.shape[1])
