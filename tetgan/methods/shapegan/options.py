"""Options of ShapeGAN (GAN) and of its training, without torch."""

from typing import Annotated, Any, Literal

from pydantic import Field

from tetgan.fields.options import VoxelOptions
from tetgan.models.method import Method, MethodOptions, Size, Sizes
from tetgan.training.options import CommonTraining


class ShapeGanOptions(MethodOptions):
    """ShapeGAN (GAN): a network of signed distance, judged by a critic of voxels that grows."""

    kind: Literal["shapegan-gan"]
    sampling: str = Field(
        "voxels-64", description="name of the sampling, a key of `samplings`, of kind voxels"
    )
    code: int = Field(128, ge=1, description="length of the latent code; the paper's is 128")
    resolution: int = Field(64, ge=8, le=256, description="cells along a side when a surface is extracted")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )


def sizes(options: ShapeGanOptions, sampling: VoxelOptions, training: Any) -> Sizes:
    """Its public code's; epochs are those of all stages: 8 voxels a side, 16, ..."""
    stages = (sampling.resolution // 4).bit_length() - 1
    epochs = sum(training.epochs) if isinstance(training.epochs, list) else stages * training.epochs
    return {
        "voxels a side": Size(sampling.resolution, 64),
        "cells a side": Size(options.resolution, 64),
        "epochs": Size(epochs, 1000),
        "fade-in epochs": Size(training.fade_in, 10),
        "batch": Size(training.batch_size, 16),
    }


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


METHOD = Method(
    ShapeGanOptions,
    build="tetgan.methods.shapegan.network:ShapeGanGenerator",
    learner="tetgan.methods.shapegan.training:ShapeGanLearner",
    training=ShapeGanTraining,
    sampling={"kind": "voxels"},
    sizes=sizes,
)
