"""What every generative model can do: draw a latent, decode it and, with an encoder, find it for a shape."""

from abc import ABC, abstractmethod

import torch
from jaxtyping import Float
from torch import Tensor, nn

from tetgan.fields.field import Field, VertexField


class LatentModel(nn.Module, ABC):
    """A decoder with a prior of its latents."""

    @property
    @abstractmethod
    def latent_shape(self) -> tuple[int, ...]:
        """Shape of one latent."""

    def sample_latent(self, count: int, generator: torch.Generator) -> Float[Tensor, "B ..."]:
        """Draws of the prior, N(0, I) if nothing else is said; the same numbers whatever the device."""
        return torch.randn(count, *self.latent_shape, generator=generator)


class FieldGenerator(LatentModel):
    """A model of fields with an encoder.

    Fields are (B, T, 4): occupancy, then displacement in units of the largest one. A decoded field has in
    place of the occupancy a logit, positive inside, and its displacement lies in [-1, 1].
    """

    @abstractmethod
    def encode(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B ..."]:
        """The latent that stands for each field: the mean, where the model gives a distribution."""

    @abstractmethod
    def decode(self, latent: Float[Tensor, "B ..."]) -> Float[Tensor, "B T 4"]:
        """Occupancy logit and displacement of each latent."""

    def meshed(self, field: Field) -> Field | VertexField:
        """What becomes a mesh where `field`, in cube sides, was decoded: itself, if nothing else is said."""
        return field
