"""Tetrahedral convolution: a tet and its four face neighbors, five weight matrices."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn

from tetgan.nn.backends import reference
from tetgan.nn.backends.choice import Kernels, backend_for, conv_backend, kernels
from tetgan.nn.neighbors import SLOTS, Side, TetNeighbors

__all__ = ["SLOTS", "TetConv", "TetNeighbors", "conv_backend", "input_gradients_only", "tet_conv"]


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
        Which kernels compute them depends on the device: see `conv_backend`.
    """
    if torch.is_autocast_enabled(x.device.type):
        dtype = torch.get_autocast_dtype(x.device.type)
        x, weight = x.to(dtype), weight.to(dtype)
        bias = bias if bias is None else bias.to(dtype)
    backend = backend_for(x.device, x.dtype)
    if backend == "reference":
        return reference.tet_conv(x, weight, bias, neighbors)
    return _Conv.apply(x, weight, bias, _Shifts(neighbors, kernels(backend)))


_weights_wanted = True


@contextmanager
def input_gradients_only() -> Iterator[None]:
    """Gradients by inputs, as in a gradient penalty: those by weights are left out, a third of the work.

    PyTorch asks a function for every gradient that its inputs could take, wanted or not.
    """
    global _weights_wanted  # noqa: PLW0603 - the backward pass of a GPU runs in another thread
    before, _weights_wanted = _weights_wanted, False
    try:
        yield
    finally:
        _weights_wanted = before


@dataclass(frozen=True)
class _Shifts:
    """The five row maps of a convolution (`side` "product") or of its adjoint, and who computes with them."""

    neighbors: TetNeighbors
    kernels: Kernels
    side: Side = "product"

    @property
    def adjoint(self) -> "_Shifts":
        return replace(self, side="adjoint" if self.side == "product" else "product")


class _Conv(torch.autograd.Function):
    """Σ_s shift_s(x) W_s + bias. Its adjoint is the same sum with adjoint shifts and transposed matrices."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, weight: Tensor, bias: Tensor | None, shifts: _Shifts) -> Tensor:
        ctx.save_for_backward(x, weight)
        ctx.shifts = shifts
        return shifts.kernels.conv(x, weight, bias, shifts.neighbors, shifts.side)

    @staticmethod
    def backward(  # type: ignore[override]
        ctx: Any, grad: Tensor
    ) -> tuple[Tensor | None, Tensor | None, Tensor | None, None]:
        x, weight = ctx.saved_tensors
        wanted = ctx.needs_input_grad[0], ctx.needs_input_grad[1] and _weights_wanted
        dx, dweight = _gradients(x, weight, grad, ctx.shifts, wanted)
        dbias = grad.sum(dim=(0, 1)) if ctx.needs_input_grad[2] and _weights_wanted else None
        return dx, dweight, dbias, None


def _gradients(
    x: Tensor, weight: Tensor, grad: Tensor, shifts: _Shifts, wanted: tuple[bool, bool]
) -> tuple[Tensor | None, Tensor | None]:
    """Those of a convolution by its features and matrices."""
    if all(wanted):
        # (shift_s*(g)ᵀ x)ᵀ = shift_s(x)ᵀ g
        dx, transposed = _Both.apply(grad, weight.mT, x, shifts.adjoint)
        return dx, transposed.mT
    dx = _Conv.apply(grad, weight.mT, None, shifts.adjoint) if wanted[0] else None
    return dx, _WeightGradient.apply(x, grad, shifts) if wanted[1] else None


class _Both(torch.autograd.Function):
    """Σ_s shift_s(x) W_s and shift_s(x)ᵀ z of every slot; a backward pass gathers once for the two."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, weight: Tensor, z: Tensor, shifts: _Shifts) -> tuple[Tensor, Tensor]:
        ctx.save_for_backward(x, weight, z)
        ctx.shifts = shifts
        ctx.set_materialize_grads(False)
        return shifts.kernels.conv_and_weight_gradient(x, weight, z, shifts.neighbors, shifts.side)

    @staticmethod
    def backward(  # type: ignore[override]
        ctx: Any, grad: Tensor | None, product_grad: Tensor | None
    ) -> tuple[Tensor | None, Tensor | None, Tensor | None, None]:
        x, weight, z = ctx.saved_tensors
        dx = dweight = dz = None
        if grad is not None:
            dx, dweight = _gradients(x, weight, grad, ctx.shifts, ctx.needs_input_grad[:2])
        if product_grad is not None and ctx.needs_input_grad[0]:
            more = _Conv.apply(z, product_grad.mT, None, ctx.shifts.adjoint)
            dx = more if dx is None else dx + more
        if product_grad is not None and ctx.needs_input_grad[2]:
            dz = _Conv.apply(x, product_grad, None, ctx.shifts)
        return dx, dweight, dz, None


class _WeightGradient(torch.autograd.Function):
    """The gradient of a convolution by its matrices, shift_s(x)ᵀ g: linear in x and in g."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, grad: Tensor, shifts: _Shifts) -> Tensor:
        ctx.save_for_backward(x, grad)
        ctx.shifts = shifts
        return shifts.kernels.weight_gradient(x, grad, shifts.neighbors, shifts.side)

    @staticmethod
    def backward(ctx: Any, weight: Tensor) -> tuple[Tensor | None, Tensor | None, None]:  # type: ignore[override]
        x, grad = ctx.saved_tensors
        dx = dgrad = None
        if ctx.needs_input_grad[0]:
            dx = _Conv.apply(grad, weight.mT, None, ctx.shifts.adjoint)
        if ctx.needs_input_grad[1]:
            dgrad = _Conv.apply(x, weight, None, ctx.shifts)
        return dx, dgrad, None


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
