"""ShapeGAN (Kleineberg et al. 2020): a network of signed distance, and a critic of voxels that grows.

The architecture is the one of its public code (docs/fidelity.md).
"""

import math
from itertools import pairwise

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from tetgan.fields.voxels import CLAMP
from tetgan.methods.shapegan.options import ShapeGanOptions
from tetgan.models.generator import ImplicitGenerator
from tetgan.nn.pointwise import joint_linear

SLOPE = 0.2

RESOLUTIONS = (8, 16, 32, 64)
"""Voxels along a side in each stage of the critic's growth."""

WIDTH = 256

CHANNELS = (1, 32, 64, 128, 256)  # of the critic, from 64³ voxels to 4³

COARSEST = 4

HIDDEN = 128


class ShapeGanGenerator(ImplicitGenerator):
    """Signed distance at a point, as DeepSDF: four layers of point and code, three of those and both again.

    The network sees the unit cube as [-1, 1]³ and distances in units of the clamp.
    """

    has_encoder = False

    def __init__(self, options: ShapeGanOptions) -> None:
        super().__init__()
        self.code, inputs = options.code, 3 + options.code
        self.cells = options.resolution
        self.first, self.again = nn.Linear(inputs, WIDTH), nn.Linear(WIDTH + inputs, WIDTH)
        self.early = nn.ModuleList(nn.Linear(WIDTH, WIDTH) for _ in range(3))
        self.late = nn.ModuleList(nn.Linear(WIDTH, WIDTH) for _ in range(2))
        self.distance = nn.Linear(WIDTH, 1)

    @property
    def latent_shape(self) -> tuple[int, ...]:
        return (self.code,)

    @property
    def level(self) -> float:
        return 0.0

    def value(self, latent: Float[Tensor, "B Z"], points: Float[Tensor, "B N 3"]) -> Float[Tensor, "B N"]:
        """Minus the signed distance, in cube sides."""
        return -CLAMP * self.clamped_distance(latent, points)

    def clamped_distance(
        self, latent: Float[Tensor, "B Z"], points: Float[Tensor, "B N 3"]
    ) -> Float[Tensor, "B N"]:
        """Signed distance at points of the unit cube, negative inside, in units of the clamp: -1 to 1."""
        points = 2 * points - 1
        x = joint_linear(self.first, points, latent).relu()
        for layer in self.early:
            x = layer(x).relu()
        x = joint_linear(self.again, torch.cat([x, points], dim=-1), latent).relu()
        for layer in self.late:
            x = layer(x).relu()
        return self.distance(x).squeeze(-1).tanh()


class VoxelCritic(nn.Module):
    """Scores voxels of 8, 16, 32 or 64 a side; each doubling puts one convolution before the others.

    A convolution that was not the first before reads the voxels through the first of its input channels.
    """

    def __init__(self) -> None:
        super().__init__()
        self.convolutions = nn.ModuleList(
            nn.Conv3d(channels, out, 4, stride=2, padding=1) for channels, out in pairwise(CHANNELS)
        )
        self.hidden = nn.Linear(CHANNELS[-1] * COARSEST**3, HIDDEN)
        self.score = nn.Linear(HIDDEN, 1)

    def forward(self, voxels: Float[Tensor, "B R R R"], fade: float = 1.0) -> Float[Tensor, "B"]:
        """Larger for voxels that look real.

        Args:
            fade: share of the first convolution; the rest is the voxels at half their resolution, so that at
                0 the score is the one of the stage before.
        """
        first = len(self.convolutions) - round(math.log2(voxels.shape[-1] / COARSEST))
        x = _convolve_one(self.convolutions[first], voxels[:, None])
        if fade < 1:
            x = fade * x
            x = torch.cat([x[:, :1] + (1 - fade) * halve(voxels)[:, None], x[:, 1:]], dim=1)
        for layer in self.convolutions[first + 1 :]:
            x = functional.leaky_relu(layer(x), SLOPE)
        return self.score(functional.leaky_relu(self.hidden(x.flatten(1)), SLOPE)).squeeze(1)


def _convolve_one(layer: nn.Module, x: Float[Tensor, "B 1 R R R"]) -> Float[Tensor, "B C r r r"]:
    """A convolution, and its activation, of an input whose channels but the first are zero."""
    assert isinstance(layer, nn.Conv3d)
    convolved = functional.conv3d(x, layer.weight[:, :1], layer.bias, layer.stride, layer.padding)  # type: ignore[arg-type]
    return functional.leaky_relu(convolved, SLOPE)


def halve(voxels: Float[Tensor, "B R R R"]) -> Float[Tensor, "B r r r"]:
    """Means of 2³ voxels."""
    half = (voxels.shape[-1] // 2, 2)
    return voxels.unflatten(3, half).unflatten(2, half).unflatten(1, half).mean(dim=(2, 4, 6))
