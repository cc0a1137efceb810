"""What the models of implicit surfaces can do: a value at any point, or distances on a cube of voxels."""

from abc import abstractmethod

from jaxtyping import Float
from torch import Tensor

from tetgan.models.generator import LatentModel


class SurfaceModel(LatentModel):
    """A model whose shapes are level sets, not fields on a tetrahedral grid.

    What it encodes is what its sampling stores (`tetgan.fields`), as single precision: points as (B, N, 4),
    position in the unit cube, then occupancy 0 or 1; voxels as (B, R, R, R), signed distance in cube sides,
    negative inside, clamped.
    """

    has_encoder: bool = True
    """Whether shapes can be reconstructed; a GAN only generates."""

    def encode(self, data: Float[Tensor, "B ..."]) -> Float[Tensor, "B ..."]:
        """The latent that stands for each shape: the mean, where the model gives a distribution.

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
