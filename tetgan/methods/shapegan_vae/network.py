"""ShapeGAN's voxel model (Kleineberg et al. 2020): a variational autoencoder of 32³ signed distances.

The architecture is the one of its public code (docs/fidelity.md).
"""

from itertools import pairwise

from jaxtyping import Float
from torch import Tensor, nn

from tetgan.fields.voxels import CLAMP
from tetgan.methods.shapegan_vae.options import ShapeGanVaeOptions
from tetgan.models.generator import VoxelGenerator

RESOLUTION = 32
SLOPE = 0.2  # of the leaky ReLU

CHANNELS = (1, 24, 48, 96)  # each of half the resolution of the one before: 32³ to 4³

WIDTH = 256  # of the single voxel that four of a side become

HIDDEN = 128


def _with_norm(layer: nn.Module, norm: nn.Module) -> list[nn.Module]:
    return [layer, norm, nn.LeakyReLU(SLOPE)]


def _encoder() -> nn.Sequential:
    layers: list[nn.Module] = []
    for channels, out in pairwise(CHANNELS):
        layers += _with_norm(nn.Conv3d(channels, out, 4, stride=2, padding=1), nn.BatchNorm3d(out))
    layers += _with_norm(nn.Conv3d(CHANNELS[-1], WIDTH, 4), nn.BatchNorm3d(WIDTH))
    layers += [nn.Flatten(), *_with_norm(nn.Linear(WIDTH, HIDDEN), nn.BatchNorm1d(HIDDEN))]
    return nn.Sequential(*layers)


def _decoder(code: int) -> nn.Sequential:
    layers = [*_with_norm(nn.Linear(code, WIDTH), nn.BatchNorm1d(WIDTH)), nn.Unflatten(1, (WIDTH, 1, 1, 1))]
    layers += _with_norm(nn.ConvTranspose3d(WIDTH, CHANNELS[-1], 4), nn.BatchNorm3d(CHANNELS[-1]))
    for channels, out in pairwise(reversed(CHANNELS[1:])):
        layers += _with_norm(nn.ConvTranspose3d(channels, out, 4, stride=2, padding=1), nn.BatchNorm3d(out))
    layers.append(nn.ConvTranspose3d(CHANNELS[1], CHANNELS[0], 4, stride=2, padding=1))
    return nn.Sequential(*layers)


class ShapeGanVae(VoxelGenerator):
    """Encoder and decoder; the networks see distances in units of the clamp.

    Batch norm and a leaky ReLU follow every layer but the two heads of the encoder and the decoder's last.
    """

    def __init__(self, options: ShapeGanVaeOptions) -> None:
        super().__init__()
        self.code = options.code
        self.encoder, self.decoder = _encoder(), _decoder(options.code)
        self.mean, self.log_variance = nn.Linear(HIDDEN, options.code), nn.Linear(HIDDEN, options.code)

    @property
    def latent_shape(self) -> tuple[int, ...]:
        return (self.code,)

    def voxels(self, latent: Float[Tensor, "B Z"]) -> Float[Tensor, "B 32 32 32"]:
        return CLAMP * self.decode(latent)

    def encode(self, data: Float[Tensor, "B 32 32 32"]) -> Float[Tensor, "B Z"]:
        return self.posterior(data / CLAMP)[0]

    def decode(self, latent: Float[Tensor, "B Z"]) -> Float[Tensor, "B 32 32 32"]:
        """Signed distance in units of the clamp."""
        return self.decoder(latent).squeeze(1)

    def posterior(
        self, voxels: Float[Tensor, "B 32 32 32"]
    ) -> tuple[Float[Tensor, "B Z"], Float[Tensor, "B Z"]]:
        """Mean and log variance of the latent of signed distances in units of the clamp."""
        features = self.encoder(voxels[:, None])
        return self.mean(features), self.log_variance(features)
