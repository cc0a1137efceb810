"""Tetrahedral convolution: a tet and its four face neighbors, five weight matrices."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Int
from scipy import sparse
from torch import Tensor, nn

from tetgan.nn.rows import RowMap

SLOTS = 5  # the tet itself, then its neighbor across the face opposite each of its four vertices
THIN = 8  # channels below which five products are too thin to keep a core busy


class TetNeighbors(nn.Module):
    """Face adjacency of one grid, prepared for gathering in both directions.

    `neighbors` (T, 4) as in `TetGrid`: -1 stands for the outside, whose row is zero. Convolutions over
    `ordered` neighbors tell the four slots apart; over unordered ones they share a matrix among them, as
    a graph convolution does.
    """

    def __init__(self, neighbors: Int[np.ndarray, "T 4"], *, ordered: bool = True) -> None:
        super().__init__()
        self.ordered = ordered
        self.slots = nn.ModuleList(RowMap(_selection(neighbors[:, slot])) for slot in range(SLOTS - 1))
        self.tets = len(neighbors)


def _selection(rows: Int[np.ndarray, "T"]) -> sparse.csr_array:
    """The (T, T) matrix that picks `rows`, and a zero row for -1."""
    picked = np.flatnonzero(rows >= 0)
    ones = np.ones(len(picked), dtype=np.float32)
    return sparse.csr_array((ones, (picked, rows[picked])), shape=(len(rows), len(rows)))


@dataclass(frozen=True)
class _Shifts:
    """The five row maps of a convolution (`side` "product") or of its adjoint ("adjoint")."""

    neighbors: TetNeighbors
    side: str = "product"

    def __call__(self, x: Tensor, slot: int) -> Tensor:
        return x if slot == 0 else self.neighbors.slots[slot - 1].sum_rows(x, self.side)  # type: ignore[operator]

    @property
    def adjoint(self) -> "_Shifts":
        return _Shifts(self.neighbors, "adjoint" if self.side == "product" else "product")


def tet_conv(
    x: Float[Tensor, "T B C"],
    weight: Float[Tensor, "5 C D"],
    bias: Float[Tensor, "D"] | None,
    neighbors: TetNeighbors,
) -> Float[Tensor, "T B D"]:
    """y[k] = x[k] W₀ + Σ_s x[n(k, s)] W_s + bias, with zero rows outside the grid.

    Args:
        x: features, tets first, so that a gathered row is B·C contiguous numbers.
        weight: one matrix for the tet itself, then one for each neighbor slot.
        bias: one number a channel, or None.
        neighbors: adjacency of the grid of `x`.

    Returns:
        Features of the same tets; the gradients are differentiable again, as gradient penalties need.
    """
    if torch.is_autocast_enabled(x.device.type):
        dtype = torch.get_autocast_dtype(x.device.type)
        x, weight = x.to(dtype), weight.to(dtype)
        bias = bias if bias is None else bias.to(dtype)
    y = _Conv.apply(x, weight, _Shifts(neighbors))
    return y if bias is None else y + bias


_weights_wanted = True


@contextmanager
def input_gradients_only() -> Iterator[None]:
    """Gradients by inputs, as in a gradient penalty: those by weights are left out, a third of the work.

    PyTorch asks a function for every gradient that its inputs could take, wanted or not.
    """
    global _weights_wanted  # noqa: PLW0603 - the backward pass of a GPU runs in another thread
    _weights_wanted = False
    try:
        yield
    finally:
        _weights_wanted = True


class _Conv(torch.autograd.Function):
    """Σ_s shift_s(x) W_s. Its adjoint is the same sum with adjoint shifts and transposed matrices."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, weight: Tensor, shifts: _Shifts) -> Tensor:
        ctx.save_for_backward(x, weight)
        ctx.shifts = shifts
        return _sum_of_products(x, weight, shifts)

    @staticmethod
    def backward(ctx: Any, grad: Tensor) -> tuple[Tensor | None, Tensor | None, None]:  # type: ignore[override]
        x, weight = ctx.saved_tensors
        dx = dweight = None
        if ctx.needs_input_grad[0]:
            dx = _Conv.apply(grad, weight.mT, ctx.shifts.adjoint)
        if ctx.needs_input_grad[1] and _weights_wanted:
            dweight = _WeightGradient.apply(x, grad, ctx.shifts)
        return dx, dweight, None


class _WeightGradient(torch.autograd.Function):
    """The gradient of a convolution by its matrices, shift_s(x)ᵀ g: linear in x and in g."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, grad: Tensor, shifts: _Shifts) -> Tensor:
        ctx.save_for_backward(x, grad)
        ctx.shifts = shifts
        return _products_over_tets(x, grad, shifts)

    @staticmethod
    def backward(ctx: Any, weight: Tensor) -> tuple[Tensor | None, Tensor | None, None]:  # type: ignore[override]
        x, grad = ctx.saved_tensors
        dx = dgrad = None
        if ctx.needs_input_grad[0]:
            dx = _Conv.apply(grad, weight.mT, ctx.shifts.adjoint)
        if ctx.needs_input_grad[1]:
            dgrad = _Conv.apply(x, weight, ctx.shifts)
        return dx, dgrad, None


def _sum_of_products(x: Tensor, weight: Tensor, shifts: _Shifts) -> Tensor:
    """Σ_s shift_s(x) W_s; shifting commutes with multiplying, so the thinner of the two sides is shifted."""
    (tets, batch, _), (_, thickness, out) = x.shape, weight.shape
    if out < thickness:
        y = torch.matmul(x, weight[0])
        for slot in range(1, SLOTS):
            y += shifts(torch.matmul(x, weight[slot]), slot)
        return y
    if thickness <= THIN:
        return torch.matmul(_columns(x, shifts), weight.flatten(0, 1))
    y = torch.mm(_flat(x), weight[0])
    for slot in range(1, SLOTS):
        y.addmm_(_flat(shifts(x, slot)), weight[slot])
    return y.view(tets, batch, out)


def _products_over_tets(x: Tensor, grad: Tensor, shifts: _Shifts) -> Tensor:
    """shift_s(x)ᵀ g of every slot, (5, C, D); again the thinner side is shifted."""
    wide_in, wide_out = x.shape[-1], grad.shape[-1]
    if wide_in < wide_out:
        if wide_in <= THIN:
            return torch.mm(_flat(_columns(x, shifts)).T, _flat(grad)).view(SLOTS, wide_in, wide_out)
        return torch.stack([torch.mm(_flat(shifts(x, slot)).T, _flat(grad)) for slot in range(SLOTS)])
    back = shifts.adjoint
    if wide_out <= THIN:
        products = torch.mm(_flat(x).T, _flat(_columns(grad, back)))
        return products.view(wide_in, SLOTS, wide_out).transpose(0, 1).contiguous()
    return torch.stack([torch.mm(_flat(x).T, _flat(back(grad, slot))) for slot in range(SLOTS)])


def _columns(x: Tensor, shifts: _Shifts) -> Tensor:
    """All five shifted copies side by side, (T, B, 5 C)."""
    return torch.cat([shifts(x, slot) for slot in range(SLOTS)], dim=-1)


def _flat(x: Tensor) -> Tensor:
    return x.reshape(-1, x.shape[-1])


class TetConv(nn.Module):
    """A tetrahedral convolution with its weights, started like a linear layer on 5 C inputs.

    `weight` holds a matrix for the tet itself, then one for each slot; over unordered neighbors, one for
    all four.
    """

    def __init__(self, channels: int, out_channels: int, neighbors: TetNeighbors, bias: bool = True) -> None:
        super().__init__()
        bound, matrices = 1 / math.sqrt(SLOTS * channels), SLOTS if neighbors.ordered else 2
        self.weight = nn.Parameter(torch.empty(matrices, channels, out_channels).uniform_(-bound, bound))
        self.bias = nn.Parameter(torch.empty(out_channels).uniform_(-bound, bound)) if bias else None
        self.neighbors = neighbors

    def forward(self, x: Float[Tensor, "T B C"]) -> Float[Tensor, "T B D"]:
        weight: Tensor = self.weight
        if not self.neighbors.ordered:
            weight = torch.cat([weight[:1], weight[1:].expand(SLOTS - 1, -1, -1)])
        return tet_conv(x, weight, self.bias, self.neighbors)
