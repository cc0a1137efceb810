"""The convolution by PyTorch's own gathers and products; written for CPUs, correct on any device.

Tets are taken in chunks whose gathered rows stay in a core's cache: written to main memory, as a gather
of all neighbors would be, they cost more than the products. Neighbors are near in memory, so the rows
that a chunk gathers mostly are in the cache as well.
"""

from collections.abc import Iterator
from math import gcd
from threading import local

import torch
from jaxtyping import Float
from torch import Tensor

from tetgan.nn.backends.plan import TABLE_BYTES, choose_method, chunk_size, rows_in_table
from tetgan.nn.neighbors import SLOTS, Bags, Side, TetNeighbors

_BIAS_ROWS = 64  # that get their bias at once


def conv(
    x: Float[Tensor, "T B C"],
    weight: Float[Tensor, "5 C D"],
    bias: Float[Tensor, "D"] | None,
    neighbors: TetNeighbors,
    side: Side,
) -> Float[Tensor, "T B D"]:
    """Σ_s shift_s(x) W_s + bias, by the method that the cost model finds cheaper for the widths."""
    method = choose_method(x.shape[0] * x.shape[1], *weight.shape[1:])
    return _METHODS[method](x.contiguous(), weight, bias, neighbors, side)


def weight_gradient(
    x: Float[Tensor, "T B C"], grad: Float[Tensor, "T B D"], neighbors: TetNeighbors, side: Side
) -> Float[Tensor, "5 C D"]:
    """shift_s(x)ᵀ g of every slot; or xᵀ shift_s*(g) with the adjoint shift, where g is thinner."""
    x, grad = x.contiguous(), grad.contiguous()
    if x.shape[2] <= grad.shape[2]:
        return _products_over_tets(x, grad, neighbors, side)
    other: Side = "adjoint" if side == "product" else "product"
    return _products_over_tets(grad, x, neighbors, other).mT


def conv_and_weight_gradient(
    x: Float[Tensor, "T B C"],
    weight: Float[Tensor, "5 C D"],
    other: Float[Tensor, "T B E"],
    neighbors: TetNeighbors,
    side: Side,
) -> tuple[Float[Tensor, "T B D"], Float[Tensor, "5 C E"]]:
    """Σ_s shift_s(x) W_s, and shift_s(x)ᵀ `other` of every slot, from rows that are gathered once."""
    thinner = min(x.shape[2], other.shape[2])
    if choose_method(x.shape[0] * x.shape[1], *weight.shape[1:], thinner) == "first":
        return conv(x, weight, None, neighbors, side), weight_gradient(x, other, neighbors, side)
    x, other = x.contiguous(), other.contiguous()
    sums = _WeightSums(x, other)
    y, matrix = x.new_empty(*x.shape[:2], weight.shape[2]), weight.flatten(0, 1)
    for columns, out, part in _columns(x, neighbors, side, y, other):
        torch.mm(columns, matrix, out=out)
        sums.add(columns, part)
    return y, sums.result()


def _multiply_columns(
    x: Tensor, weight: Tensor, bias: Tensor | None, neighbors: TetNeighbors, side: Side
) -> Tensor:
    """Five rows side by side, then one product; the bias is added while its results are in the cache."""
    y, matrix = x.new_empty(*x.shape[:2], weight.shape[2]), weight.flatten(0, 1)
    for columns, out in _columns(x, neighbors, side, y):
        torch.mm(columns, matrix, out=out)
        if bias is not None:
            _add_to_rows(out, bias)
    return y


def _multiply_first(
    x: Tensor, weight: Tensor, bias: Tensor | None, neighbors: TetNeighbors, side: Side
) -> Tensor:
    """All five products of every tet, then sums of five rows: gathering commutes with multiplying.

    The bias is a row behind the table that every sum takes as its last.
    """
    tets, batch, channels = x.shape
    out = weight.shape[2]
    width = rows_in_table(out)
    wide = x.new_zeros(channels, width * out)
    wide[:, : SLOTS * out] = weight.transpose(0, 1).flatten(1)
    table = _scratch(x, tets * batch + 1, wide.shape[1])
    torch.mm(x.view(-1, channels), wide, out=table[:-1])
    if bias is not None:
        table[-1, :out] = bias
    sums = neighbors.gathers(side, batch).sums(width, and_last=bias is not None)
    return _sum_rows(table.view(-1, out), sums).view(tets, batch, out)


class _Kept(local):
    """Memory for products, a block for each Python thread: new pages would cost more than the products."""

    block = torch.empty(0, dtype=torch.uint8)


_kept = _Kept()


def _scratch(x: Tensor, rows: int, columns: int) -> Tensor:
    """Room of the kind of `x`, which the next caller overwrites."""
    size = rows * columns * x.element_size()
    if size > TABLE_BYTES or x.device.type != "cpu":
        return x.new_empty(rows, columns)
    if len(_kept.block) < size:
        _kept.block = torch.empty(size, dtype=torch.uint8)
    return _kept.block[:size].view(x.dtype).view(rows, columns)


def _add_to_rows(y: Float[Tensor, "N D"], bias: Float[Tensor, "D"]) -> None:
    """The bias to every row, many rows at a time: a loop over a few channels costs more than the bytes."""
    rows = gcd(len(y), _BIAS_ROWS)
    y.view(-1, rows * len(bias)).add_(bias.repeat(rows))


def _columns(x: Tensor, neighbors: TetNeighbors, side: Side, *along: Tensor) -> Iterator[tuple[Tensor, ...]]:
    """Chunks of tets: five rows of each tet and shape side by side, (n·B, 5 C), and its row of `along`."""
    _, batch, channels = x.shape
    rows, size = x.view(-1, channels), chunk_size(x, *along)
    parts = [tensor.flatten(0, 1).split(size * batch) for tensor in along]
    for chunk, *beside in zip(neighbors.gathers(side, batch).chunks(size), *parts, strict=True):
        yield _sum_rows(rows, chunk.bags()).view(-1, SLOTS * channels), *beside


def _products_over_tets(x: Tensor, grad: Tensor, neighbors: TetNeighbors, side: Side) -> Tensor:
    """shift_s(x)ᵀ g, summed over chunks."""
    sums = _WeightSums(x, grad)
    for columns, part in _columns(x, neighbors, side, grad):
        sums.add(columns, part)
    return sums.result()


class _WeightSums:
    """Sums over chunks of columns (n, 5 C) transposed times a part (n, E) of `other`; float32 at least.

    Kept as (E, 5 C) unless E is the greater: a product with long rows is faster.
    """

    def __init__(self, x: Tensor, other: Tensor) -> None:
        self.shape, self.dtype = (SLOTS, x.shape[2], other.shape[2]), x.dtype
        self.turned = SLOTS * x.shape[2] > 2 * other.shape[2]
        size = SLOTS * x.shape[2], other.shape[2]
        dtype = torch.promote_types(x.dtype, torch.float32)
        self.total = torch.zeros(size[::-1] if self.turned else size, dtype=dtype, device=x.device)

    def add(self, columns: Tensor, part: Tensor) -> None:
        left, right = (part.T, columns) if self.turned else (columns.T, part)
        if self.total.dtype == left.dtype:
            self.total.addmm_(left, right)
        else:
            self.total += torch.mm(left, right)

    def result(self) -> Float[Tensor, "5 C E"]:
        total = self.total.T.contiguous() if self.turned else self.total
        return total.view(self.shape).to(self.dtype)


def _sum_rows(x: Float[Tensor, "N W"], bags: Bags) -> Tensor:
    # Of a tensor that asks for gradients, embedding_bag would note down which bag each row is in.
    return torch.embedding_bag(x.detach(), bags.rows, bags.starts, mode=0, include_last_offset=True)[0]


_METHODS = {"columns": _multiply_columns, "first": _multiply_first}
