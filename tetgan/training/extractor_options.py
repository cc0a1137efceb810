"""How the PointNet++ classifier is trained whose features the Fréchet distance compares."""

from pathlib import Path

from pydantic import Field

from tetgan.options import Options


class ExtractorOptions(Options):
    """One classifier for all categories of a run."""

    checkpoint: Path | None = Field(
        None, description="Folder of a classifier trained before (weights.safetensors, options.json); none: train one."
    )
    train: int = Field(64, ge=2, description="Training clouds per category.")
    holdout: int = Field(48, ge=2, description="Hold-out clouds per category on which accuracy is logged.")
    epochs: int = Field(8, ge=1, description="Passes over the training clouds.")
    batch_size: int = Field(24, ge=2, description="Clouds per step.")
    learning_rate: float = Field(1e-3, gt=0, le=1, description="Of Adam.")
    weight_decay: float = Field(1e-4, ge=0, le=1, description="Of Adam.")
    decay_every: int = Field(20, ge=1, description="Epochs between two reductions of the learning rate.")
    decay: float = Field(0.7, gt=0, le=1, description="Factor of such a reduction.")
    rotate: bool = Field(
        False,
        description="Turn training clouds about the vertical axis at random; no: shapes keep their canonical yaw.",
    )
    noise_samples: int = Field(96, ge=8, description="Clouds on each side of the noise curve (noise.csv).")
    seed: int = Field(0, ge=0, description="Of the choice of clouds, the initial weights, their order and dropout.")
