"""Which training options go with which kind of model."""

from tetgan.models.kinds import kind_of
from tetgan.models.options import KindOptions
from tetgan.options import Options
from tetgan.training.common import CommonTraining
from tetgan.training.options import TrainingOptions

# What other kinds take from the common training options, which are TetGAN's: these do not touch the weights.
_COMMON = set(CommonTraining.model_fields) - {"batch_size"}


def training_class(model: KindOptions) -> type[Options]:
    """The class of training options of a model."""
    found: type[Options] = kind_of(model).load("training")
    return found


def training_options(model: KindOptions, common: TrainingOptions) -> Options:
    """Training options of a model: the common ones, then its own.

    A kind with a class of its own has its own hyperparameters, so of the common options only those count that
    do not touch the weights.

    Raises:
        UserError: the model's own options have a key that its kind does not know, or a bad value.
    """
    kind = training_class(model)
    heeded = None if kind is TrainingOptions else _COMMON
    return kind.parse(common.model_dump(include=heeded) | getattr(model, "training", {}), "training")
