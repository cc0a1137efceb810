"""Tetrahedral layers on active sets: convolution, learned pooling and upsampling."""

import math
from typing import Any, NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from tetgan.nn.conv import SLOTS

FACES = SLOTS - 1

CHILDREN = 8


class ActiveNeighbors(NamedTuple):
    """Face adjacency of N active tets, of one shape or of several.

    Attributes:
        rows: (N, 5) the tet itself, then its neighbours; N, the row of zeros, where none is active.
        back: (N, 4) for each neighbour and the slot in which it has this tet, their place in a table (N, 4);
            4 N where there is none.
    """

    rows: Int[Tensor, "N 5"]
    back: Int[Tensor, "N 4"]

    @classmethod
    def of_table(cls, neighbors: Int[Tensor, "N 4"], back: Int[Tensor, "N 4"]) -> "ActiveNeighbors":
        """From an `ActiveLevel`'s: places, with -1 for a missing neighbour, and slots that lead back."""
        count, missing = len(neighbors), neighbors < 0
        around = torch.where(missing, count, neighbors)
        itself = torch.arange(count, dtype=around.dtype, device=around.device)[:, None]
        back = around * FACES + torch.where(missing, 0, back).to(around.dtype)
        return cls(torch.cat([itself, around], dim=1), back)


def active_conv(
    x: Float[Tensor, "N C"],
    weight: Float[Tensor, "5 C D"],
    bias: Float[Tensor, "D"],
    neighbors: ActiveNeighbors,
) -> Float[Tensor, "N D"]:
    """y[k] = x[k] W₀ + Σ_s x[n(k, s)] W_s + bias, with zero rows for neighbours that are not active.

    Under autocast in its number format.
    """
    if torch.is_autocast_enabled(x.device.type):
        dtype = torch.get_autocast_dtype(x.device.type)
        x, weight, bias = x.to(dtype), weight.to(dtype), bias.to(dtype)
    y: Tensor = _ActiveConv.apply(x, weight, bias, neighbors)
    return y


def _with_zero(rows: Float[Tensor, "N C"]) -> Float[Tensor, "N+1 C"]:
    return torch.cat([rows, rows.new_zeros(1, rows.shape[1])])


class _ActiveConv(torch.autograd.Function):
    """One product with the five gathered rows side by side; its adjoint gathers too, and scatters nothing."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, weight: Tensor, bias: Tensor, neighbors: ActiveNeighbors) -> Tensor:
        columns = _with_zero(x).index_select(0, neighbors.rows.flatten()).view(len(x), SLOTS * x.shape[1])
        ctx.save_for_backward(columns, weight, neighbors.back)
        return torch.addmm(bias, columns, weight.flatten(0, 1))

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, grad: Tensor) -> tuple[Tensor | None, Tensor, Tensor, None]:  # type: ignore[override]
        columns, weight, back = ctx.saved_tensors
        dx = None
        if ctx.needs_input_grad[0]:
            # What each tet owes to the neighbour in each slot, fetched by that neighbour.
            channels = weight.shape[1]
            owed = grad.new_empty(len(grad) * FACES + 1, channels)
            owed[-1] = 0
            there = weight[1:].permute(2, 0, 1).flatten(1)
            torch.mm(grad, there, out=owed[:-1].view(len(grad), FACES * channels))
            dx = torch.addmm(owed.index_select(0, back[:, 0]), grad, weight[0].T)
            for slot in range(1, FACES):
                dx += owed.index_select(0, back[:, slot])
        return dx, (columns.T @ grad).view_as(weight), grad.sum(dim=0), None


class ActiveConv(nn.Module):
    """A convolution with its weights, started like those of a linear layer on 5 C inputs, times `gain`."""

    def __init__(self, channels: int, out_channels: int, gain: float = 1.0) -> None:
        super().__init__()
        bound = 1 / math.sqrt(SLOTS * channels)
        start = torch.empty(SLOTS, channels, out_channels).uniform_(-bound, bound)
        self.weight = nn.Parameter(gain * start)
        self.bias = nn.Parameter(torch.zeros(out_channels))

    def forward(self, x: Float[Tensor, "N C"], neighbors: ActiveNeighbors) -> Float[Tensor, "N D"]:
        return active_conv(x, self.weight, self.bias, neighbors)


class ActivePool(nn.Linear):
    """Features of each eight children, side by side, to those of their parent."""

    def __init__(self, channels: int, out_channels: int) -> None:
        super().__init__(CHILDREN * channels, out_channels)

    def forward(self, x: Float[Tensor, "N C"]) -> Float[Tensor, "N//8 D"]:
        return super().forward(x.view(len(x) // CHILDREN, self.in_features))


class ActiveUpsample(nn.Linear):
    """Features of each split tet to those of its eight children, a matrix for each."""

    def __init__(self, channels: int, out_channels: int) -> None:
        super().__init__(channels, CHILDREN * out_channels)

    def forward(self, x: Float[Tensor, "P C"]) -> Float[Tensor, "8*P D"]:
        return super().forward(x).view(CHILDREN * len(x), self.out_features // CHILDREN)
