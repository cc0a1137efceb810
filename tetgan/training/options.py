"""Training options: those of every method, and those of one model."""

from typing import Literal

from pydantic import Field

from tetgan.models.method import MethodOptions
from tetgan.models.registry import method_of
from tetgan.options import Options


class CommonTraining(Options):
    """Options that the loop itself reads."""

    batch_size: int = Field(16, ge=1, description="shapes a step")
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
    learning_rate: float = Field(1e-3, gt=0, description="Adam's step size")


# What other kinds take from the common training options, which are TetGAN's: these do not touch the weights.
_COMMON = set(CommonTraining.model_fields) - {"batch_size"}


def training_class(model: MethodOptions) -> type[Options]:
    """The class of training options of a model."""
    found: type[Options] = method_of(model).load("training")
    return found


def training_options(model: MethodOptions, common: Options) -> Options:
    """Training options of a model: the common ones, then its own.

    A kind with a class of its own has its own hyperparameters, so of the common options only those count that
    do not touch the weights.

    Raises:
        UserError: the model's own options have a key that its kind does not know, or a bad value.
    """
    kind = training_class(model)
    heeded = None if isinstance(common, kind) else _COMMON
    return kind.parse(common.model_dump(include=heeded) | getattr(model, "training", {}), "training")
