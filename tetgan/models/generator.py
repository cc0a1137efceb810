"""Contracts of generative models: latents, fields, implicit surfaces, voxels."""

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

    def draw_noise(self, generator: torch.Generator) -> Float[Tensor, "..."]:
        """The random numbers behind one draw of the prior, on the CPU; standard normal by default."""
        return torch.randn(self.latent_shape, generator=generator)

    def from_noise(self, noise: Float[Tensor, "B ..."]) -> Float[Tensor, "B ..."]:
        """Draws of the prior from such numbers, which are on the model's device; N(0, I) by default."""
        return noise


class FieldGenerator(LatentModel):
    """A model of fields with an encoder.

    Fields are (B, T, 4): occupancy, then displacement in units of the largest one. A decoded field has in
    place of the occupancy a logit, positive inside, and its displacement lies in [-1, 1].
    """

    is_identity = False
    """Whether it passes stored fields on as they are, and so has neither code nor prior."""

    @abstractmethod
    def encode(self, field: Float[Tensor, "B T 4"]) -> Float[Tensor, "B ..."]:
        """The latent of each field: the mean, where the model gives a distribution."""

    @abstractmethod
    def decode(self, latent: Float[Tensor, "B ..."]) -> Float[Tensor, "B T 4"]:
        """Occupancy logit and displacement of each latent."""

    def meshed(self, field: Field) -> Field | VertexField:
        """Field to be meshed for a decoded `field`, in cube sides; by default itself."""
        return field


class SurfaceModel(LatentModel):
    """A model whose shapes are level sets, not fields on a tetrahedral grid.

    What it encodes is what its sampling stores (`tetgan.fields`), as single precision: points as (B, N, 4),
    position in the unit cube, then occupancy 0 or 1; voxels as (B, R, R, R), signed distance in cube sides,
    negative inside, clamped.
    """

    has_encoder: bool = True
    """Whether shapes can be reconstructed; a GAN only generates."""

    def encode(self, data: Float[Tensor, "B ..."]) -> Float[Tensor, "B ..."]:
        """The latent of each shape: the mean, where the model gives a distribution.

        Raises:
            NotImplementedError: the model has no encoder.
        """
        raise NotImplementedError(f"{type(self).__name__} has no encoder")


class ImplicitGenerator(SurfaceModel):
    """A decoder that answers point by point."""

    cells: int = 64
    """Along a side of the grid on which its surface is searched."""

    halvings: int = 0
    """How many times cells on the surface are halved."""

    @abstractmethod
    def value(self, latent: Float[Tensor, "B ..."], points: Float[Tensor, "B N 3"]) -> Float[Tensor, "B N"]:
        """At each point of the unit cube a value that is above `level` inside the shape.

        A logit of the occupancy, or minus a signed distance.
        """

    @property
    @abstractmethod
    def level(self) -> float:
        """The value at the surface."""


class VoxelGenerator(SurfaceModel):
    """A decoder that answers for a whole cube at once."""

    @abstractmethod
    def voxels(self, latent: Float[Tensor, "B ..."]) -> Float[Tensor, "B R R R"]:
        """Signed distance at the cell centres of the unit cube, in cube sides, negative inside."""
