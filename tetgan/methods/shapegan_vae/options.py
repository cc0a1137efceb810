"""Options of ShapeGAN (VAE) and of its training, without torch."""

from typing import Any, Literal

from pydantic import Field

from tetgan.fields.options import VoxelOptions
from tetgan.models.method import Method, MethodOptions, Size, Sizes
from tetgan.training.options import CommonTraining


class ShapeGanVaeOptions(MethodOptions):
    """ShapeGAN (VAE): a variational autoencoder of 32³ voxels of signed distance."""

    kind: Literal["shapegan-vae"]
    sampling: str = Field(
        "voxels-32", description="name of the sampling, a key of `samplings`, of 32³ voxels"
    )
    code: int = Field(128, ge=1, description="length of the latent code; the paper's is 128")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )


def sizes(options: ShapeGanVaeOptions, sampling: VoxelOptions, training: Any) -> Sizes:
    """Its public code's, which trains as long as one likes."""
    return {
        "voxels a side": Size(sampling.resolution, 32),
        "epochs": Size(training.epochs, 500, stated=False),
        "batch": Size(training.batch_size, 32),
    }


class ShapeGanVaeTraining(CommonTraining):
    """ShapeGAN (VAE): Adam on absolute differences and KL divergence."""

    epochs: int = Field(500, ge=1, description="passes over the training split")
    batch_size: int = Field(32, ge=3, description="shapes a step; batch norm needs a few")
    learning_rate: float = Field(5e-5, gt=0, description="Adam's step size")
    inside_weight: float = Field(32.0, gt=0, description="weight of voxels inside the shape")
    kl_weight: float = Field(1.0, ge=0, description="weight of the KL divergence, a mean over the code")


METHOD = Method(
    ShapeGanVaeOptions,
    build="tetgan.methods.shapegan_vae.network:ShapeGanVae",
    learner="tetgan.methods.shapegan_vae.training:ShapeGanVaeLearner",
    training=ShapeGanVaeTraining,
    sampling={"kind": "voxels", "resolution": 32},
    sizes=sizes,
)
