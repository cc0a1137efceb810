"""The convolution by PyTorch's own gathers and products; written for CPUs, correct on any device.

Tets are taken in chunks whose gathered rows stay in a core's cache: written to main memory, as a gather
of all neighbors would be, they cost more than the products. Neighbors are near in memory, so the rows
that a chunk gathers mostly are in the cache as well.
"""

from collections.abc import Iterator

import torch
from jaxtyping import Float
from torch import Tensor

from tetgan.nn.backends.plan import choose_method, chunk_size
from tetgan.nn.neighbors import SLOTS, Bags, Side, TetNeighbors


def conv(
    x: Float[Tensor, "T B C"],
    weight: Float[Tensor, "5 C D"],
    bias: Float[Tensor, "D"] | None,
    neighbors: TetNeighbors,
    side: Side,
) -> Float[Tensor, "T B D"]:
    """Σ_s shift_s(x) W_s + bias, by the method that the cost model finds cheapest for the shape."""
    x = x.contiguous()
    method = choose_method(x.shape[1], *weight.shape[1:])
    return _METHODS[method](x, weight, bias, neighbors, side)


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
    method = choose_method(x.shape[1], *weight.shape[1:])
    if method == "first":
        return conv(x, weight, None, neighbors, side), weight_gradient(x, other, neighbors, side)
    x, other, total = x.contiguous(), other.contiguous(), _zeros(x, other)
    y = x.new_empty(*x.shape[:2], weight.shape[2])
    if x.shape[1] == 1:
        matrix = _transposed(weight)
        for tets, columns in _columns(x, neighbors, side):
            torch.mm(columns, matrix, out=y[tets, 0])
            total += torch.mm(columns.T, other[tets, 0]).view_as(total)
        return y, total.to(x.dtype)
    for tets, own, gathered in _slots(x, neighbors, side):
        _accumulate(own, gathered, weight, None, y[tets].flatten(0, 1))
        _add_products(total, own, gathered, other[tets].flatten(0, 1))
    return y, total.to(x.dtype)


def _multiply_columns(
    x: Tensor, weight: Tensor, bias: Tensor | None, neighbors: TetNeighbors, side: Side
) -> Tensor:
    """Five rows side by side, then one product; B is 1."""
    y, matrix = x.new_empty(len(x), weight.shape[2]), _transposed(weight)
    for tets, columns in _columns(x, neighbors, side):
        _multiply(columns, matrix, bias, y[tets])
    return y.unsqueeze(1)


def _accumulate_products(
    x: Tensor, weight: Tensor, bias: Tensor | None, neighbors: TetNeighbors, side: Side
) -> Tensor:
    """A product for each slot, added to the chunk's output while it is in the cache."""
    y = x.new_empty(*x.shape[:2], weight.shape[2])
    for tets, own, gathered in _slots(x, neighbors, side):
        _accumulate(own, gathered, weight, bias, y[tets].flatten(0, 1))
    return y


def _columns(x: Tensor, neighbors: TetNeighbors, side: Side) -> Iterator[tuple[slice, Tensor]]:
    """Chunks of tets, and for each its five rows side by side, (n, 5 C); B is 1."""
    flat = x.flatten(1)
    for first, last, bags in neighbors.tetwise(side, chunk_size(x)):
        yield slice(first, last), _sum_rows(flat, bags).view(last - first, -1)


def _slots(x: Tensor, neighbors: TetNeighbors, side: Side) -> Iterator[tuple[slice, Tensor, Tensor]]:
    """Chunks of tets, and for each its own rows (n·B, C) and the four neighbors' (4, n·B, C)."""
    flat = x.flatten(1)
    for first, last, bags in neighbors.slotwise(side, chunk_size(x)):
        own = x[first:last].flatten(0, 1)
        yield slice(first, last), own, _sum_rows(flat, bags).view(SLOTS - 1, *own.shape)


def _accumulate(own: Tensor, gathered: Tensor, weight: Tensor, bias: Tensor | None, out: Tensor) -> None:
    matrix, *matrices = weight.unbind()
    _multiply(own, matrix, bias, out)
    for rows, matrix in zip(gathered.unbind(), matrices, strict=True):
        out.addmm_(rows, matrix)


def _add_products(total: Tensor, own: Tensor, gathered: Tensor, other: Tensor) -> None:
    total[0] += torch.mm(own.T, other)
    total[1:] += torch.bmm(gathered.mT, other.expand(SLOTS - 1, -1, -1))


def _transposed(weight: Tensor) -> Tensor:
    """(5 C, D) in column order, in which a product of long rows is fastest."""
    return weight.flatten(0, 1).T.contiguous().T


def _zeros(x: Tensor, other: Tensor) -> Tensor:
    """Sums over chunks, in float32 at least."""
    dtype = torch.promote_types(x.dtype, torch.float32)
    return torch.zeros(SLOTS, x.shape[2], other.shape[2], dtype=dtype, device=x.device)


def _multiply_first(
    x: Tensor, weight: Tensor, bias: Tensor | None, neighbors: TetNeighbors, side: Side
) -> Tensor:
    """All five products of every tet, then one sum of five rows: gathering commutes with multiplying."""
    tets, batch, _ = x.shape
    slot_first = batch > 1 or weight.shape[2] == 1
    products = (_products_slot_first if slot_first else _products_tet_first)(x, weight, bias)
    return _sum_rows(products, neighbors.sums(side, slot_first=slot_first)).view(tets, batch, -1)


def _products_tet_first(x: Tensor, weight: Tensor, bias: Tensor | None) -> Tensor:
    """(5 T, D), the five rows of a tet together; B is 1."""
    wide, wide_bias = _side_by_side(weight, bias)
    products = x.new_empty(len(x), wide.shape[1])
    _multiply(x.flatten(0, 1), wide, wide_bias, products)
    return products.view(-1, weight.shape[2])


def _products_slot_first(x: Tensor, weight: Tensor, bias: Tensor | None) -> Tensor:
    """(5 T, B·D), the rows of a slot together."""
    tets, batch, _ = x.shape
    out = weight.shape[2]
    products = x.new_empty(SLOTS, tets, batch, out)
    if out == 1:
        for slot in range(SLOTS):
            own = bias if slot == 0 else None
            _multiply(x.flatten(0, 1), weight[slot], own, products[slot].flatten(0, 1))
        return products.view(SLOTS * tets, -1)
    wide, wide_bias = _side_by_side(weight, bias)
    size = chunk_size(x)
    for first in range(0, tets, size):
        part = x[first : first + size].flatten(0, 1)
        chunk = part.new_empty(len(part), wide.shape[1])
        _multiply(part, wide, wide_bias, chunk)
        products[:, first : first + size] = chunk.view(-1, batch, SLOTS, out).permute(2, 0, 1, 3)
    return products.view(SLOTS * tets, -1)


def _side_by_side(weight: Tensor, bias: Tensor | None) -> tuple[Tensor, Tensor | None]:
    """One matrix (C, 5 D), and the bias beside that of the tet itself, whose row is in every sum."""
    wide = weight.transpose(0, 1).flatten(1)
    return wide, bias if bias is None else torch.cat([bias, bias.new_zeros(len(bias) * (SLOTS - 1))])


def _products_over_tets(x: Tensor, grad: Tensor, neighbors: TetNeighbors, side: Side) -> Tensor:
    """shift_s(x)ᵀ g, summed over chunks."""
    total = _zeros(x, grad)
    if x.shape[1] == 1:
        for tets, columns in _columns(x, neighbors, side):
            total += torch.mm(columns.T, grad[tets, 0]).view_as(total)
    else:
        for tets, own, gathered in _slots(x, neighbors, side):
            _add_products(total, own, gathered, grad[tets].flatten(0, 1))
    return total.to(x.dtype)


def _sum_rows(x: Float[Tensor, "N W"], bags: Bags) -> Tensor:
    return torch.embedding_bag(x, bags.rows, bags.starts, mode=0, include_last_offset=True)[0]


def _multiply(x: Tensor, matrix: Tensor, bias: Tensor | None, out: Tensor) -> None:
    if bias is None:
        torch.mm(x, matrix, out=out)
    else:
        torch.addmm(bias, x, matrix, out=out)


_METHODS = {
    "columns": _multiply_columns,
    "accumulate": _accumulate_products,
    "first": _multiply_first,
}
