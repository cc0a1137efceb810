"""Local and global Wasserstein critic (paper's supplement A).

Their last layers have no bias: only differences of scores count, so its gradient would be nothing but
rounding, which Adam enlarges to whole steps.
"""

from jaxtyping import Float
from torch import Tensor, nn

from tetgan.methods.tetgan.network import (
    FIELD_CHANNELS,
    Stages,
    TetHierarchy,
    conv_layers,
    level_widths,
    tets_first,
)
from tetgan.nn.conv import TetConv
from tetgan.nn.resample import TetPool

LOCAL_DOUBLINGS = 4

GLOBAL_CONVOLUTIONS = 3  # of each block


class LocalCritic(nn.Module):
    """Six convolutions at the finest level, 4 → w → 2w → … → 16w → 1; the score is the mean over tets."""

    def __init__(self, hierarchy: TetHierarchy, width: int) -> None:
        super().__init__()
        neighbors = hierarchy.neighbors[-1]
        widths = [width * 2**step for step in range(LOCAL_DOUBLINGS + 1)]
        self.layers = conv_layers([FIELD_CHANNELS, *widths], neighbors)
        self.score = TetConv(widths[-1], 1, neighbors, bias=False)

    def forward(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B"]:
        """Larger for fields that look real; occupancy as a probability."""
        return self.score(self.layers(tets_first(field))).float().mean(dim=(0, 2))


class GlobalCritic(nn.Module):
    """A block of three convolutions a level, pooling between, then a linear layer over the coarsest grid."""

    def __init__(self, hierarchy: TetHierarchy, width: int) -> None:
        super().__init__()
        depth = len(hierarchy.tets) - 1
        widths = level_widths(depth, width, base=width * 2**depth)
        blocks, channels = [], FIELD_CHANNELS
        for level in reversed(range(len(widths))):
            steps = [channels] + GLOBAL_CONVOLUTIONS * [widths[level]]
            blocks.append(conv_layers(steps, hierarchy.neighbors[level], TetPool() if level > 0 else None))
            channels = widths[level]
        self.blocks = Stages(*blocks)
        self.score = nn.Linear(hierarchy.tets[0] * channels, 1, bias=False)

    def forward(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B"]:
        """Larger for fields that look real; occupancy as a probability."""
        features = self.blocks(tets_first(field))
        return self.score(features.transpose(0, 1).flatten(1)).float().squeeze(1)
