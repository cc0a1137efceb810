"""TetGAN's autoencoder: encoder, latent head and decoder (paper's supplement A)."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional
from torch.utils.checkpoint import checkpoint

from tetgan.grids.hierarchy import GridHierarchy
from tetgan.methods.tetgan.options import TetganOptions
from tetgan.methods.tetgan.prior import FittedPrior
from tetgan.models.generator import FieldGenerator
from tetgan.nn.conv import TetConv, TetNeighbors
from tetgan.nn.norm import SLOPE, TetInstanceNorm
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


CONVOLUTIONS = 4  # of each block


# Start of a latent head from features: codes have variance 1, so four deviations keep nearly all of them
# positive; posteriors begin at a variance of e^-3 = 0.05; components below the rounding of single precision
# are left out.
STRAIGHT, LOG_VARIANCE, ROUNDING = 4.0, -3.0, 1e-5


class Encoder(nn.Module):
    """A block of four convolutions a level, pooling between them: (T, B, channels) to (K, B, widths[0])."""

    def __init__(
        self, hierarchy: TetHierarchy, channels: int, widths: list[int], pool: Literal["max", "mean"]
    ) -> None:
        super().__init__()
        blocks = []
        for level in reversed(range(len(widths))):
            steps = [channels] + CONVOLUTIONS * [widths[level]]
            pooling = TetPool(pool) if level > 0 else None
            blocks.append(conv_layers(steps, hierarchy.neighbors[level], pooling))
            channels = widths[level]
        self.blocks = Stages(*blocks)

    def forward(self, x: Float[Tensor, "T B F"]) -> Float[Tensor, "K B C"]:
        return self.blocks(x)


class Decoder(nn.Module):
    """The encoder reversed: the last convolution of each block changes the width, then the grid is refined.

    The very last convolution has neither norm nor activation.
    """

    def __init__(self, hierarchy: TetHierarchy, widths: list[int], channels: int) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        for level, (width, finer) in enumerate(pairwise(widths)):
            steps = CONVOLUTIONS * [width] + [finer]
            layers += [conv_layers(steps, hierarchy.neighbors[level]), hierarchy.upsamplings[level]]
        layers.append(conv_layers(CONVOLUTIONS * [widths[-1]], hierarchy.neighbors[-1]))
        layers.append(TetConv(widths[-1], channels, hierarchy.neighbors[-1]))
        self.layers = Stages(*layers)

    def forward(self, x: Float[Tensor, "K B C"]) -> Float[Tensor, "T B F"]:
        return self.layers(x)


class LatentHead(nn.Module):
    """From the coarsest features to mean and log variance, and back.

    `global`: linear layers over the whole coarsest grid, one code a shape. `tet`: the same layers over the
    channels of each coarse tet. `conv`: tetrahedral convolutions instead, one code a coarse tet too.
    """

    def __init__(self, options: TetganOptions, neighbors: TetNeighbors, channels: int) -> None:
        super().__init__()
        self.folds = options.latent == "global"
        self.latent_shape = (options.code,) if self.folds else (neighbors.tets, options.code)
        self.unfolded = (neighbors.tets, channels)
        features = neighbors.tets * channels if self.folds else channels

        def layer(inputs: int, outputs: int) -> nn.Linear | TetConv:
            if options.latent == "conv":
                return TetConv(inputs, outputs, neighbors)
            return nn.Linear(inputs, outputs)

        self.hidden = layer(features, options.code)
        self.mean = layer(options.code, options.code)
        self.log_variance = layer(options.code, options.code)
        self.expand = layer(options.code, features)

    def encode(self, x: Float[Tensor, "K B C"]) -> tuple[Float[Tensor, "B ..."], Float[Tensor, "B ..."]]:
        if self.folds:
            x = x.transpose(0, 1).flatten(1)
        hidden = functional.leaky_relu(self.hidden(x), SLOPE)
        mean, log_variance = self.mean(hidden), self.log_variance(hidden)
        if self.folds:
            return mean, log_variance
        return mean.transpose(0, 1), log_variance.transpose(0, 1)

    def decode(self, latent: Float[Tensor, "B ..."]) -> Float[Tensor, "K B C"]:
        if self.folds:
            return tets_first(self.expand(latent).unflatten(1, self.unfolded))
        return self.expand(tets_first(latent))

    @torch.no_grad()
    def start_from(self, features: Float[Tensor, "K N C"]) -> None:
        """Set the weights so that codes are the whitened principal components of the features of many shapes.

        Gradient steps find these slowly. What a code has beyond the number of components keeps its random
        start, and the decoder does not listen to it yet.
        """
        rows = features.transpose(0, 1).flatten(1) if self.folds else features.flatten(0, 1)
        middle = rows.mean(dim=0)
        _, lengths, directions = torch.linalg.svd(rows - middle, full_matrices=False)
        kept = min(self.latent_shape[-1], int((lengths > ROUNDING * lengths[0]).sum()))
        deviations, directions = lengths[:kept, None] / math.sqrt(len(rows)), directions[:kept]
        whiten = directions / deviations
        # Shifted to the straight side of the leaky ReLU, and shifted back by the mean.
        _set_outputs(self.hidden, slice(kept), whiten, STRAIGHT - whiten @ middle)
        identity = torch.eye(kept, self.latent_shape[-1], device=rows.device)
        _set_outputs(self.mean, slice(kept), identity, torch.full_like(middle[:kept], -STRAIGHT))
        constant = identity.new_full((self.latent_shape[-1],), LOG_VARIANCE)
        _set_outputs(
            self.log_variance, slice(None), torch.zeros_like(constant).expand(len(constant), -1), constant
        )
        back = torch.zeros(len(middle), self.latent_shape[-1], device=rows.device)
        back[:, :kept] = (directions * deviations).T
        _set_outputs(self.expand, slice(None), back, middle)


def _set_outputs(
    layer: nn.Linear | TetConv, outputs: slice, weight: Float[Tensor, "D C"], bias: Float[Tensor, "D"]
) -> None:
    """Some outputs of a linear layer, or of a convolution that then sees the tet itself alone."""
    matrix = layer.weight
    if isinstance(layer, TetConv):
        matrix[1:, :, outputs] = 0
        matrix = matrix[0].T
    assert layer.bias is not None
    matrix[outputs], layer.bias[outputs] = weight, bias


class TetganGenerator(FieldGenerator):
    """The variational autoencoder, whose decoder is also the generator that the critics judge.

    Without `displacement` it reads and writes occupancy alone: wherever fields have displacements, losses
    and critics included, there are zeros.
    """

    def __init__(self, options: TetganOptions, hierarchy: GridHierarchy) -> None:
        super().__init__()
        self.hierarchy = TetHierarchy(hierarchy, options.upsample, options.convolution)
        self.channels = FIELD_CHANNELS if options.displacement else 1
        widths = level_widths(hierarchy.depth, options.width, options.base_width or options.code)
        self.encoder = Encoder(self.hierarchy, self.channels, widths, options.pool)
        self.head = LatentHead(options, self.hierarchy.neighbors[0], widths[0])
        self.decoder = Decoder(self.hierarchy, widths, self.channels)
        self.range = options.displacement_range
        self.prior = FittedPrior(self.head.latent_shape) if options.prior == "fitted" else None

    @property
    def latent_shape(self) -> tuple[int, ...]:
        return self.head.latent_shape

    def sample_latent(self, count: int, generator: torch.Generator) -> Float[Tensor, "B ..."]:
        """Draws of the prior for a step of training, whose numbers depend on `count`."""
        if self.prior is None:
            return torch.randn(count, *self.latent_shape, generator=generator)
        return self.prior.sample(count, generator)

    def draw_noise(self, generator: torch.Generator) -> Float[Tensor, "..."]:
        if self.prior is None:
            return super().draw_noise(generator)
        return self.prior.draw_noise(generator)

    def from_noise(self, noise: Float[Tensor, "B ..."]) -> Float[Tensor, "B ..."]:
        if self.prior is None:
            return super().from_noise(noise)
        return self.prior.from_noise(noise)

    def encode(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B ..."]:
        return self.posterior(field)[0]

    def decode_features(self, features: Float[Tensor, "K B C"]) -> Float[Tensor, "B T 4"]:
        """Decode the coarsest features themselves, without the latent head."""
        field = self._padded(self.decoder(features).transpose(0, 1).float())
        return torch.cat([field[..., :1], self.range * field[..., 1:].tanh()], dim=-1)

    def in_range(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B T 4"]:
        """The field as the networks see it: displacements in units of the range, larger ones clipped."""
        displacement = (field[..., 1 : self.channels] / self.range).clamp(-1, 1)
        return self._padded(torch.cat([field[..., :1], displacement], dim=-1))

    def _padded(self, field: Float[Tensor, "B T F"]) -> Float[Tensor, "B T 4"]:
        """Zeros for the displacement that this network does not know."""
        return functional.pad(field, (0, FIELD_CHANNELS - self.channels))

    def features(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "K B C"]:
        """The encoder's coarsest features, which the latent head reads."""
        return self.encoder(tets_first(self.in_range(field)[..., : self.channels]))

    def posterior(
        self, field: Float[Tensor, "B T 4"]
    ) -> tuple[Float[Tensor, "B ..."], Float[Tensor, "B ..."]]:
        """Mean and log variance of the latent of each field."""
        mean, log_variance = self.head.encode(self.features(field))
        return mean.float(), log_variance.float()

    def decode(self, latent: Float[Tensor, "B ..."]) -> Float[Tensor, "B T 4"]:
        return self.decode_features(self.head.decode(latent))
