"""The autoencoder: residual blocks of active convolutions, and a code in every coarsest tet."""

from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from tetgan.methods.tetflow.shapes import ActiveBatch
from tetgan.nn.sparse import ActiveConv, ActiveNeighbors, ActivePool, ActiveUpsample

FINEST_INPUTS = 5  # side, distance clipped, normal

FINEST_OUTPUTS = 4  # distance, normal

COARSER_OUTPUTS = 2  # occupied share and split, as logits

CLIP = 2.0  # largest distance that is told apart, in units of the reach

LOG_VARIANCES = (-8.0, 4.0)


class Block(nn.Module):
    """x + conv(SiLU(conv(norm(x)))), nearly the identity at the start.

    Sums stay in single precision whatever the convolutions compute in.
    """

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(channels)
        self.first, self.second = ActiveConv(channels, channels), ActiveConv(channels, channels, gain=0.1)

    def forward(self, x: Float[Tensor, "N C"], neighbors: ActiveNeighbors) -> Float[Tensor, "N C"]:
        return x + self.second(functional.silu(self.first(self.norm(x), neighbors)), neighbors)


class Blocks(nn.ModuleList):
    """Blocks of one level."""

    def __init__(self, channels: int, count: int) -> None:
        super().__init__(Block(channels) for _ in range(count))

    def forward(self, x: Float[Tensor, "N C"], neighbors: ActiveNeighbors) -> Float[Tensor, "N C"]:
        for block in self:
            x = block(x, neighbors)
        return x


class Encoder(nn.Module):
    """From a shape on its active set to mean and log variance of its code."""

    def __init__(self, tets: int, code: int, widths: Sequence[int], blocks: int) -> None:
        """`tets` of the coarsest level; `widths` of all levels, coarse to fine."""
        super().__init__()
        finest = len(widths) - 1
        self.enter = nn.ModuleList(
            nn.Linear(FINEST_INPUTS if level == finest else 1, width) for level, width in enumerate(widths)
        )
        self.blocks = nn.ModuleList(
            Blocks(width, 1 if level == finest else blocks) for level, width in enumerate(widths)
        )
        self.pool = nn.ModuleList(ActivePool(widths[level + 1], widths[level]) for level in range(finest))
        self.place = nn.Parameter(0.02 * torch.randn(tets, widths[0]))
        self.head = nn.Linear(widths[0], 2 * code)

    def forward(self, batch: ActiveBatch) -> tuple[Float[Tensor, "B K Z"], Float[Tensor, "B K Z"]]:
        clipped = batch.distance.clamp(-CLIP, CLIP)
        told = torch.cat([batch.distance.sign()[:, None], clipped[:, None], batch.normal], dim=1)
        x = self.enter[-1](told).float()
        if len(batch.levels) == 1:
            x = self._placed(x, batch.shapes)
        x = self.blocks[-1](x, batch.levels[-1].neighbors)
        for number in reversed(range(len(batch.levels) - 1)):
            level = batch.levels[number]
            pooled = self.pool[number](x).float()
            x = self.enter[number](level.share[:, None]).float().index_add(0, level.parents, pooled)
            x = self.blocks[number](x if number else self._placed(x, batch.shapes), level.neighbors)
        mean, log_variance = self.head(x).float().view(batch.shapes, len(self.place), -1).chunk(2, dim=-1)
        return mean, log_variance.clamp(*LOG_VARIANCES)

    def _placed(self, x: Float[Tensor, "N C"], count: int) -> Float[Tensor, "N C"]:
        return x + self.place.repeat(count, 1)


class Decoder(nn.Module):
    """From a code, level by level: what each tet holds, then features of the children of split ones."""

    def __init__(self, tets: int, code: int, widths: Sequence[int], blocks: int) -> None:
        super().__init__()
        finest = len(widths) - 1
        self.enter = nn.Linear(code, widths[0])
        self.place = nn.Parameter(0.02 * torch.randn(tets, widths[0]))
        self.blocks = nn.ModuleList(
            Blocks(width, (1 if level == finest else blocks) + 1) for level, width in enumerate(widths)
        )
        self.leave = nn.ModuleList(
            nn.Linear(width, FINEST_OUTPUTS if level == finest else COARSER_OUTPUTS)
            for level, width in enumerate(widths)
        )
        self.upsample = nn.ModuleList(
            ActiveUpsample(widths[level], widths[level + 1]) for level in range(finest)
        )

    def start(self, code: Float[Tensor, "B K Z"]) -> Float[Tensor, "N C"]:
        """Features of the coarsest tets of all shapes."""
        return (self.enter(code).float() + self.place).flatten(0, 1)

    def level(
        self, number: int, x: Float[Tensor, "N C"], neighbors: ActiveNeighbors
    ) -> tuple[Float[Tensor, "N C"], Float[Tensor, "N O"]]:
        """Features behind a level's blocks, and its outputs."""
        x = self.blocks[number](x, neighbors)
        return x, self.leave[number](x).float()

    def rise(self, number: int, x: Float[Tensor, "P C"]) -> Float[Tensor, "N D"]:
        """Features of the children of a level's split tets."""
        features: Tensor = self.upsample[number](x).float()
        return features

    def forward(self, code: Float[Tensor, "B K Z"], batch: ActiveBatch) -> list[Float[Tensor, "_N _O"]]:
        """Outputs of every level, where tets are split as those of the batch are."""
        x, outputs = self.start(code), []
        for number, level in enumerate(batch.levels):
            x, output = self.level(number, x, level.neighbors)
            outputs.append(output)
            if number < len(self.upsample):
                x = self.rise(number, x.index_select(0, level.parents))
        return outputs


class Autoencoder(nn.Module):
    """Encoder and decoder; channels double from the finest level up to `base_width`."""

    def __init__(self, tets: int, depth: int, *, code: int, width: int, base_width: int, blocks: int) -> None:
        super().__init__()
        widths = [min(width << (depth - level), base_width) for level in range(depth + 1)]
        self.encoder = Encoder(tets, code, widths, blocks)
        self.decoder = Decoder(tets, code, widths, blocks)
