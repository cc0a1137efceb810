"""Which training options go with which kind of model."""

from typing import Any

from tetgan.models.options import ModelOptions
from tetgan.options import Options
from tetgan.training.baselines.options import OccNetTraining, ShapeGanTraining, ShapeGanVaeTraining
from tetgan.training.options import TrainingOptions

_OF_BASELINES: dict[str, type[Options]] = {
    "occnet": OccNetTraining,
    "shapegan-gan": ShapeGanTraining,
    "shapegan-vae": ShapeGanVaeTraining,
}

# What baselines take from the common training options: these do not touch the weights.
_COMMON = ("device", "validate_every", "checkpoint_seconds")


def training_class(model: ModelOptions) -> type[Options]:  # type: ignore[valid-type]
    """The class of training options of a model; TetGAN's for those that nothing is trained for."""
    return _OF_BASELINES.get(model.kind, TrainingOptions)  # type: ignore[attr-defined]


def training_options(model: ModelOptions, common: TrainingOptions) -> Options:  # type: ignore[valid-type]
    """Training options of a model: the common ones, then its own.

    A baseline has its own hyperparameters, so of the common options only those count that do not touch the
    weights.

    Raises:
        UserError: the model's own options have a key that its kind does not know, or a bad value.
    """
    kind = training_class(model)
    values: dict[str, Any] = common.model_dump()
    if kind is not TrainingOptions:
        values = {key: values[key] for key in _COMMON}
    return kind.parse(values | getattr(model, "training", {}), "training")
