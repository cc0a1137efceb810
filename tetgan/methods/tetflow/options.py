"""Options of TetFlow and of its training, without torch."""

from typing import Any, Literal

from pydantic import Field, model_validator

from tetgan.models.method import Method, MethodOptions
from tetgan.training.options import CommonTraining


class TetflowOptions(MethodOptions):
    """TetFlow: an autoencoder on the tets near the surface, and a flow that draws its codes."""

    kind: Literal["tetflow"]
    grid: str = Field(description="name of the grid, a key of `grids`")
    code: int = Field(4, ge=1, description="numbers in the code of a coarsest tet")
    reach: float = Field(
        1.15,
        gt=0,
        description="tets nearer to the surface than this are active, in cube roots of a finest tet's volume",
    )
    width: int = Field(24, ge=1, description="channels at the finest level, doubled at each coarser one")
    base_width: int = Field(128, ge=1, description="most channels of a level")
    blocks: int = Field(
        2,
        ge=1,
        description="residual blocks a level of the encoder, but one at the finest; one more in the decoder",
    )
    flow_width: int = Field(128, ge=8, multiple_of=8, description="channels of the flow's transformer")
    flow_layers: int = Field(6, ge=1, description="layers of the flow's transformer")
    flow_heads: int = Field(4, ge=1, description="attention heads of each, a divisor of `flow_width`")
    flow_steps: int = Field(30, ge=1, description="steps from noise to a code, by Heun's method")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )
    meshing: dict[str, Any] = Field(
        default_factory=dict, description="meshing options that differ for this model"
    )

    @model_validator(mode="after")
    def _heads_divide(self) -> "TetflowOptions":
        if self.flow_width % self.flow_heads:
            raise ValueError("flow_width must be a multiple of flow_heads")
        return self


class TetflowTraining(CommonTraining):
    """TetFlow: first the autoencoder, then the flow on its codes."""

    epochs: int = Field(40, ge=1, description="passes of the autoencoder over the training split")
    batch_size: int = Field(4, ge=1, description="shapes a step of the autoencoder")
    learning_rate: float = Field(
        2e-3, gt=0, description="Adam's step size for the autoencoder, which falls by half a cosine"
    )
    split_weight: float = Field(2.0, gt=0, description="weight of tets that are split, in the loss of splits")
    kl_weight: float = Field(
        0.03, ge=0, description="weight of the KL term, a mean over the numbers of a code"
    )
    ema: float = Field(
        0.998, gt=0, lt=1, description="decay of the running mean of the autoencoder's weights"
    )
    flow_epochs: int = Field(
        30, ge=0, description="epochs of the flow afterwards, of as many steps as one of the autoencoder"
    )
    flow_batch_size: int = Field(16, ge=1, description="codes a step of the flow")
    flow_learning_rate: float = Field(
        1e-3, gt=0, description="Adam's step size for the flow, which falls too"
    )
    flow_ema: float = Field(0.998, gt=0, lt=1, description="decay of the running mean of the flow's weights")
    warmup: int = Field(
        100, ge=0, description="steps in which each step size rises, but no more than a tenth of all"
    )
    gradient_clip: float = Field(1.0, gt=0, description="largest norm of a gradient")
    precision: Literal["fp32", "bf16"] = Field(
        "fp32",
        description="number format of products; bf16 leaves sums and losses in single precision, and is slow "
        "on processors that have no instructions for it",
    )


METHOD = Method(
    TetflowOptions,
    build="tetgan.methods.tetflow.network:TetflowGenerator",
    learner="tetgan.methods.tetflow.training:TetflowLearner",
    training=TetflowTraining,
)
