"""Gaussian prior with the training codes' mean and low-rank covariance."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

RANK = 256


class FittedPrior(nn.Module):
    """The normal distribution of the training codes: their mean, and their covariance up to a rank.

    It serves models whose codes are not independent under training, above all those with one code a coarse
    tet, where independent draws put together parts of different shapes. Before it is fitted it is N(0, I).
    """

    def __init__(self, latent_shape: tuple[int, ...]) -> None:
        super().__init__()
        size = torch.Size(latent_shape).numel()
        self.latent_shape = latent_shape
        self.mean = nn.Buffer(torch.zeros(size))
        self.directions = nn.Buffer(torch.zeros(RANK, size))
        self.noise = nn.Buffer(torch.ones(size))

    @torch.no_grad()
    def fit(self, means: Float[Tensor, "N ..."], variances: Float[Tensor, "N ..."]) -> None:
        """Match the posteriors of N training shapes, given by mean and variance.

        The covariance is that of the means, which couples the parts of a code, plus the mean variance of
        the posteriors, in each element by itself.
        """
        means = means.flatten(1)
        self.mean.copy_(means.mean(dim=0))
        _, lengths, directions = torch.linalg.svd(means - self.mean, full_matrices=False)
        kept = min(RANK, len(lengths))
        deviations = lengths[:kept, None] / max(len(means) - 1, 1) ** 0.5
        self.directions.zero_()
        self.directions[:kept] = deviations * directions[:kept]
        self.noise.copy_(variances.flatten(1).mean(dim=0).sqrt())

    def sample(self, count: int, generator: torch.Generator) -> Float[Tensor, "B ..."]:
        """Draws on the device of this module, of numbers from the CPU so that they do not depend on it."""
        together = torch.randn(count, RANK, generator=generator)
        apart = torch.randn(count, len(self.mean), generator=generator)
        return self._placed(together.to(self.mean.device), apart.to(self.mean.device))

    def draw_noise(self, generator: torch.Generator) -> Float[Tensor, "N"]:
        """The numbers behind one draw: of the directions, then of each element by itself."""
        return torch.cat([torch.randn(part, generator=generator) for part in (RANK, len(self.mean))])

    def from_noise(self, noise: Float[Tensor, "B N"]) -> Float[Tensor, "B ..."]:
        """Draws from such numbers, on the device of this module."""
        return self._placed(noise[:, :RANK], noise[:, RANK:])

    def _placed(self, together: Float[Tensor, "B R"], apart: Float[Tensor, "B Z"]) -> Float[Tensor, "B ..."]:
        codes = self.mean + together @ self.directions + apart * self.noise
        return codes.view(-1, *self.latent_shape)
