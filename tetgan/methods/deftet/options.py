"""Options of the surface network, without torch."""

from typing import Any, Literal

from pydantic import Field

from tetgan.grids.options import GridOptions
from tetgan.models.method import Method, MethodOptions, Size, Sizes, of_data
from tetgan.training.options import CommonTraining


class DeftetOptions(MethodOptions):
    """DefTet's surface network: a graph convolution moves the boundary that another model decodes."""

    kind: Literal["deftet"]
    grid: str = Field(description="name of the grid, a key of `grids`")
    of: str = Field(description="name of the TetGAN model that gives the occupancy, on the same grid")
    width: int = Field(64, ge=1, description="channels of the graph convolutions")
    blocks: int = Field(3, ge=1, description="residual blocks of two graph convolutions each")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )


def sizes(options: DeftetOptions, grid: GridOptions, training: Any) -> Sizes:
    """The length of its own training, as long as the paper's of TetGAN."""
    return of_data(options, grid, training) | {
        "epochs": Size(training.epochs, 100),
        "batch": Size(training.batch_size, 30),
    }


class DeftetTraining(CommonTraining):
    """DefTet: Adam on squared errors of vertex displacements."""

    epochs: int = Field(100, ge=1, description="passes over the training split")
    batch_size: int = Field(30, ge=1, description="shapes a step")
    learning_rate: float = Field(1e-4, gt=0, description="Adam's step size")
    betas: tuple[float, float] = Field((0.0, 0.9), description="Adam's decay rates of the two moments")
    decay: Literal["constant", "cosine"] = Field(
        "constant", description="course of the step size: constant, or a half cosine down to a hundredth"
    )
    ema: float | None = Field(
        None, gt=0, lt=1, description="decay of the running mean of the weights that is kept; empty: none"
    )


METHOD = Method(
    DeftetOptions,
    build="tetgan.methods.deftet.network:DeftetGenerator",
    learner="tetgan.methods.deftet.training:DeftetLearner",
    training=DeftetTraining,
    of=("tetgan",),
    sizes=sizes,
    one_mode=True,
)
