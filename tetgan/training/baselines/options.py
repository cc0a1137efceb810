"""How the baselines are trained: each has its own options, whose defaults are those of its public code.

That code trains OccNet and ShapeGAN's autoencoder for as long as one likes; their numbers of epochs are ours.
"""

from typing import Annotated

from pydantic import Field

from tetgan.training.common import CommonTraining


class OccNetTraining(CommonTraining):
    """OccNet: Adam on cross-entropy and KL divergence."""

    epochs: int = Field(1000, ge=1, description="passes over the training split")
    batch_size: int = Field(64, ge=1, description="shapes a step")
    points: int = Field(2048, ge=1, description="points of each shape a step")
    learning_rate: float = Field(1e-4, gt=0, description="Adam's step size")


class ShapeGanTraining(CommonTraining):
    """ShapeGAN (GAN): WGAN-GP by RMSprop, with a critic that grows."""

    epochs: Annotated[int, Field(ge=1)] | list[Annotated[int, Field(ge=1)]] = Field(
        250, description="passes over the training split at each resolution; a list has one number for each"
    )
    batch_size: int = Field(16, ge=1, description="shapes a step")
    learning_rate: float = Field(1e-4, gt=0, description="RMSprop's step size of both networks")
    gradient_penalty: float = Field(10.0, ge=0, description="weight of the critic's gradient penalty")
    critic_steps: int = Field(5, ge=1, description="critic batches for each generator batch")
    fade_in: float = Field(10.0, ge=0, description="epochs over which a new resolution is blended in")


class ShapeGanVaeTraining(CommonTraining):
    """ShapeGAN (VAE): Adam on absolute differences and KL divergence."""

    epochs: int = Field(500, ge=1, description="passes over the training split")
    batch_size: int = Field(32, ge=3, description="shapes a step; batch norm needs a few")
    learning_rate: float = Field(5e-5, gt=0, description="Adam's step size")
    inside_weight: float = Field(32.0, gt=0, description="weight of voxels inside the shape")
    kl_weight: float = Field(1.0, ge=0, description="weight of the KL divergence, a mean over the code")
