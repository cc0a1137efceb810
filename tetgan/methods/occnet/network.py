"""OccNet without an input (Mescheder et al. 2019): a variational autoencoder of occupancy at points.

The architecture is the one of its public code for unconditional generation (docs/fidelity.md).
"""

import math
from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor, nn

from tetgan.methods.occnet.options import OccNetOptions
from tetgan.models.generator import ImplicitGenerator
from tetgan.nn.pointwise import joint_linear

WIDTH = 128

BLOCKS = 5

ENCODED = 2048


class PointEncoder(nn.Module):
    """A PointNet of positions and occupancies; the last two layers also see the maxima of the one before."""

    def __init__(self, code: int) -> None:
        super().__init__()
        self.position, self.occupancy = nn.Linear(3, WIDTH), nn.Linear(1, WIDTH)
        self.first = nn.Linear(WIDTH, WIDTH)
        self.pooled: Sequence[nn.Linear] = nn.ModuleList(  # type: ignore[assignment]
            nn.Linear(2 * WIDTH, WIDTH) for _ in range(2)
        )
        self.mean, self.log_deviation = nn.Linear(WIDTH, code), nn.Linear(WIDTH, code)

    def forward(
        self, points: Float[Tensor, "B N 3"], occupancy: Float[Tensor, "B N"]
    ) -> tuple[Float[Tensor, "B Z"], Float[Tensor, "B Z"]]:
        """Mean and log variance."""
        x = self.first((self.position(points) + self.occupancy(occupancy[..., None])).relu())
        for layer in self.pooled:
            assert isinstance(layer, nn.Linear)
            x = joint_linear(layer, x.relu(), x.amax(dim=1).relu())
        features = x.amax(dim=1)
        return self.mean(features), 2 * self.log_deviation(features)


class ResidualBlock(nn.Module):
    """x + layer(relu(layer(relu(x)))), the identity at the start."""

    def __init__(self) -> None:
        super().__init__()
        self.inner, self.outer = nn.Linear(WIDTH, WIDTH), nn.Linear(WIDTH, WIDTH)
        nn.init.zeros_(self.outer.weight)
        nn.init.zeros_(self.outer.bias)

    def forward(self, x: Float[Tensor, "B N C"]) -> Float[Tensor, "B N C"]:
        return x + self.outer(self.inner(x.relu()).relu())


class PointDecoder(nn.Module):
    """The occupancy's logit at points, given a code."""

    def __init__(self, code: int) -> None:
        super().__init__()
        self.position, self.code = nn.Linear(3, WIDTH), nn.Linear(code, WIDTH)
        self.blocks = nn.Sequential(*(ResidualBlock() for _ in range(BLOCKS)))
        self.logit = nn.Linear(WIDTH, 1)

    def forward(self, latent: Float[Tensor, "B Z"], points: Float[Tensor, "B N 3"]) -> Float[Tensor, "B N"]:
        x = self.position(points) + self.code(latent)[:, None]
        return self.logit(self.blocks(x).relu()).squeeze(-1)


class OccNetGenerator(ImplicitGenerator):
    """Encoder and decoder; the networks see the unit cube as [-½, ½]³."""

    def __init__(self, options: OccNetOptions) -> None:
        super().__init__()
        self.code, self.threshold = options.code, options.threshold
        self.cells, self.halvings = options.mise_start, options.mise_steps
        self.encoder, self.decoder = PointEncoder(options.code), PointDecoder(options.code)
        self.encoded = nn.Buffer(torch.tensor(ENCODED))  # points of each shape that training encodes

    @property
    def latent_shape(self) -> tuple[int, ...]:
        return (self.code,)

    @property
    def level(self) -> float:
        return math.log(self.threshold / (1 - self.threshold))

    def value(self, latent: Float[Tensor, "B Z"], points: Float[Tensor, "B N 3"]) -> Float[Tensor, "B N"]:
        """Logit of the occupancy."""
        return self.decoder(latent, points - 0.5)

    def posterior(self, data: Float[Tensor, "B N 4"]) -> tuple[Float[Tensor, "B Z"], Float[Tensor, "B Z"]]:
        """Mean and log variance of the latent of shapes that are known at points of the unit cube."""
        return self.encoder(data[..., :3] - 0.5, data[..., 3])

    def encode(self, data: Float[Tensor, "B N 4"]) -> Float[Tensor, "B Z"]:
        """Posterior mean; of the points as many as in training, for the encoder takes maxima over them."""
        return self.posterior(data[:, : int(self.encoded)])[0]
