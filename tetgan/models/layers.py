"""Parts shared by the encoder, the decoder and the critics."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.utils.checkpoint import checkpoint

from tetgan.grids.hierarchy import GridHierarchy
from tetgan.nn.conv import TetConv, TetNeighbors
from tetgan.nn.norm import TetInstanceNorm
from tetgan.nn.resample import TetPool, TetUpsample

FIELD_CHANNELS = 4


class TetHierarchy(nn.Module):
    """The neighbors of each level and the upsamplings between levels, coarse to fine; no weights."""

    def __init__(
        self,
        hierarchy: GridHierarchy,
        upsample: Literal["inverse_distance", "copy"] = "inverse_distance",
        convolution: Literal["tet", "shared"] = "tet",
    ) -> None:
        super().__init__()
        ordered = convolution == "tet"
        self.neighbors: Sequence[TetNeighbors] = nn.ModuleList(  # type: ignore[assignment]
            TetNeighbors(grid.neighbors, ordered=ordered) for grid in hierarchy.levels
        )
        self.upsamplings: Sequence[TetUpsample] = nn.ModuleList(  # type: ignore[assignment]
            TetUpsample(coarse, fine, upsample) for coarse, fine in pairwise(hierarchy.levels)
        )
        self.tets = [len(grid.tets) for grid in hierarchy.levels]


def level_widths(depth: int, width: int, base: int) -> list[int]:
    """Channels of each level, coarse to fine: `width` at the finest, doubled at each coarser, then `base`."""
    return [base, *(width * 2**level for level in reversed(range(depth)))]


def conv_layers(widths: Sequence[int], neighbors: TetNeighbors, pool: TetPool | None = None) -> nn.Sequential:
    """Convolutions through `widths`, each followed by instance norm and leaky ReLU; the last pools first.

    The convolutions have no bias, because the norm would take it off again.
    """
    layers: list[nn.Module] = []
    for channels, out in pairwise(widths):
        layers += [TetConv(channels, out, neighbors, bias=False), TetInstanceNorm()]
    if pool is not None:
        layers.insert(-1, pool)
    return nn.Sequential(*layers)


class Stages(nn.Sequential):
    """Modules one after the other, whose inner features are computed again for the backward pass if
    `checkpointing` is set, rather than kept.
    """

    checkpointing = False

    def forward(self, x: Tensor) -> Tensor:
        for stage in self:
            if self.checkpointing and torch.is_grad_enabled():
                x = checkpoint(stage, x, use_reentrant=False, preserve_rng_state=False)
            else:
                x = stage(x)
        return x


def use_checkpointing(module: nn.Module) -> None:
    """Set it in all stages of a network."""
    for part in module.modules():
        if isinstance(part, Stages):
            part.checkpointing = True


def tets_first(field: Float[Tensor, "B T C"]) -> Float[Tensor, "T B C"]:
    """The layout inside the networks, where a gathered row is contiguous."""
    return field.transpose(0, 1).contiguous()
