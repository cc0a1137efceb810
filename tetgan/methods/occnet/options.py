"""Options of OccNet and of its training, without torch."""

from typing import Any, Literal

from pydantic import Field

from tetgan.fields.options import PointOptions
from tetgan.models.method import Method, MethodOptions, Size, Sizes
from tetgan.training.options import CommonTraining


class OccNetOptions(MethodOptions):
    """OccNet without an input to condition on: a variational autoencoder of occupancy at points."""

    kind: Literal["occnet"]
    sampling: str = Field("points", description="name of the sampling, a key of `samplings`, of kind points")
    code: int = Field(128, ge=1, description="length of the latent code; the paper's is 128")
    mise_start: int = Field(32, ge=2, description="cells along a side of the coarsest grid that is evaluated")
    mise_steps: int = Field(
        2, ge=0, le=5, description="how many times cells on the surface are halved: 32 and 2 make 128"
    )
    threshold: float = Field(0.2, gt=0, lt=1, description="occupancy probability at the surface")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )


def sizes(options: OccNetOptions, sampling: PointOptions, training: Any) -> Sizes:
    """Its public code's, which trains as long as one likes."""
    return {
        "points": Size(sampling.count, 100_000),
        "points a step": Size(training.points, 2048),
        "cells a side": Size(options.mise_start * 2**options.mise_steps, 128),
        "epochs": Size(training.epochs, 1000, stated=False),
        "batch": Size(training.batch_size, 64),
    }


class OccNetTraining(CommonTraining):
    """OccNet: Adam on cross-entropy and KL divergence."""

    epochs: int = Field(1000, ge=1, description="passes over the training split")
    batch_size: int = Field(64, ge=1, description="shapes a step")
    points: int = Field(2048, ge=1, description="points of each shape a step")
    learning_rate: float = Field(1e-4, gt=0, description="Adam's step size")


METHOD = Method(
    OccNetOptions,
    build="tetgan.methods.occnet.network:OccNetGenerator",
    learner="tetgan.methods.occnet.training:OccNetLearner",
    training=OccNetTraining,
    sampling={"kind": "points"},
    sizes=sizes,
)
