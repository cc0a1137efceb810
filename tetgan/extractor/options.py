"""Training options of the PointNet++ classifier."""

from pathlib import Path

from pydantic import Field

from tetgan.options import Options


class ExtractorOptions(Options):
    """One classifier for all categories of a run."""

    checkpoint: Path | None = Field(
        default=None,
        description="folder of a trained classifier (weights.safetensors, options.json); none: train one",
    )
    train: int = Field(default=64, ge=2, description="training clouds per category")
    holdout: int = Field(
        default=48, ge=2, description="hold-out clouds per category on which accuracy is logged"
    )
    epochs: int = Field(default=8, ge=1, description="passes over the training clouds")
    batch_size: int = Field(default=24, ge=2, description="clouds per step")
    learning_rate: float = Field(default=1e-3, gt=0, le=1, description="of Adam")
    weight_decay: float = Field(default=1e-4, ge=0, le=1, description="of Adam")
    decay_every: int = Field(
        default=20, ge=1, description="epochs between two reductions of the learning rate"
    )
    decay: float = Field(default=0.7, gt=0, le=1, description="factor of such a reduction")
    rotate: bool = Field(
        default=False,
        description="turn training clouds about the vertical axis at random; no: shapes keep their yaw",
    )
    noise_samples: int = Field(
        default=96, ge=8, description="clouds on each side of the noise curve (noise.csv)"
    )
    seed: int = Field(
        default=0, ge=0, description="of the choice of clouds, the initial weights, their order and dropout"
    )
