"""Training options that methods share, without torch."""

from typing import ClassVar, Literal

from pydantic import Field

from tetgan.options import Options


class CommonTraining(Options):
    """Options that every method heeds."""

    may_change: ClassVar[frozenset[str]] = frozenset({"device", "validate_every", "checkpoint_seconds"})
    """May change between a run and its resumption: weights depend on these by rounding at most."""

    device: Literal["auto", "cpu", "cuda"] = Field(
        "auto", description="where to train; auto: CUDA if present"
    )
    validate_every: int = Field(
        10, ge=1, description="epochs between two validation rows of the log, where there is an encoder"
    )
    checkpoint_seconds: float = Field(120.0, ge=0, description="least time between two checkpoints")


class FieldTraining(CommonTraining):
    """A model of fields with one optimiser, Adam."""

    epochs: int = Field(100, ge=1, description="passes over the training split")
    batch_size: int = Field(16, ge=1, description="shapes a step")
    learning_rate: float = Field(1e-3, gt=0, description="Adam's step size")
