"""Options of the surface network, without torch."""

from typing import Any, Literal

from pydantic import Field

from tetgan.models.method import Method, MethodOptions


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


METHOD = Method(
    DeftetOptions,
    build="tetgan.methods.deftet.network:DeftetGenerator",
    train="tetgan.methods.deftet.training:train_deftet",
    training="tetgan.methods.tetgan.options:TetganTraining",
    of=("tetgan",),
    one_mode=True,
)
