"""Stage: points or voxels in, a trained baseline out."""

import logging
import math
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Int
from torch import Tensor, nn

from tetgan.fields.samplings import PointStore, VoxelStore
from tetgan.models.options import ImplicitOptions, OccNetOptions, ShapeGanOptions
from tetgan.models.registry import save_generator
from tetgan.training.baselines.learner import BaselineLearner
from tetgan.training.baselines.occnet import OccNetLearner
from tetgan.training.baselines.options import (
    BaselineTraining,
    OccNetTraining,
    ShapeGanTraining,
    ShapeGanVaeTraining,
)
from tetgan.training.baselines.shapegan import ShapeGanLearner
from tetgan.training.baselines.shapegan_vae import ShapeGanVaeLearner
from tetgan.training.checkpoint import run_digest
from tetgan.training.loop import WITHOUT_EFFECT, Losses, TrainingLoop, step_draws

log = logging.getLogger(__name__)


def train_baseline(
    index: Path, options: ImplicitOptions, training: BaselineTraining, seed: int, folder: Path
) -> None:
    """Train a baseline on the training split of an index of points or voxels.

    One that diverges is no error: the weights of the last epoch without infinities are kept, and
    `options.json` says in which epoch it happened.

    Args:
        index: `index.json` of the sampling that the model names.
        folder: receives `options.json`, `weights.safetensors`, `log.csv`, `events/` and `checkpoint.pt`.

    Raises:
        UserError: the index does not hold what the model learns from.
    """
    learner = build_learner(index, options, training, seed)
    BaselineTrainer(learner, options, training, seed, folder).run()


def build_learner(
    index: Path, options: ImplicitOptions, training: BaselineTraining, seed: int
) -> BaselineLearner:
    """The networks of a baseline, untrained, and its data."""
    if isinstance(options, OccNetOptions):
        assert isinstance(training, OccNetTraining)
        return OccNetLearner(options, training, PointStore.open(index), seed)
    if isinstance(options, ShapeGanOptions):
        assert isinstance(training, ShapeGanTraining)
        return ShapeGanLearner(options, training, VoxelStore.open(index), seed)
    assert isinstance(training, ShapeGanVaeTraining)
    return ShapeGanVaeLearner(options, training, VoxelStore.open(index), seed)


class BaselineTrainer(TrainingLoop):
    """A run of a baseline."""

    def __init__(
        self,
        learner: BaselineLearner,
        options: ImplicitOptions,
        training: BaselineTraining,
        seed: int,
        folder: Path,
    ) -> None:
        self.learner, self.options, self.training = learner, options, training
        self.columns = ("epoch", "seconds", *learner.losses)
        self.last_finite = LastFinite(learner.generator)
        own = options.model_dump(exclude={"training"})
        digests = {
            "options": run_digest(model=own, training=training.model_dump(exclude=WITHOUT_EFFECT), seed=seed),
            "data": learner.data_digest,
        }
        super().__init__(
            folder,
            seed,
            epochs=learner.epochs,
            steps_per_epoch=math.ceil(learner.shapes / training.batch_size),
            checkpoint_seconds=training.checkpoint_seconds,
            digests=digests,
        )

    def take_step(self, draws: torch.Generator) -> Losses:
        return self.learner.take_step(self._rows(), self.step, self.step / self.steps_per_epoch, draws)

    def _rows(self) -> Int[Tensor, "B"]:
        """The shapes of this step. Each epoch has an order of its own, cut into parts as equal as can be."""
        epoch, place = divmod(self.step, self.steps_per_epoch)
        order = torch.randperm(self.learner.shapes, generator=step_draws(self.seed, self.steps + epoch))
        return order.tensor_split(self.steps_per_epoch)[place]

    def finish_epoch(self, epoch: int) -> None:
        """Validate where that is due; give up where a loss or a weight is no longer finite."""
        further = {"seconds": self.elapsed()}
        if self.step == self.steps or epoch % self.training.validate_every == 0:
            further |= self.learner.validate()
        row = self.log.finish_epoch(epoch, further)
        if all(map(math.isfinite, row.values())) and self.last_finite.keep():
            return
        log.warning("diverged in epoch %d; the weights of the epoch before are kept", epoch)
        self.last_finite.diverged = epoch
        self.steps = self.step

    def parts(self) -> dict[str, Any]:
        return {**self.learner.parts(), "last_finite": self.last_finite}

    def save(self) -> None:
        """The last weights, or the last finite ones."""
        self.learner.generator.load_state_dict(self.last_finite.weights)
        save_generator(
            self.folder,
            self.learner.generator,
            self.options,
            training=self.training.model_dump(mode="json"),
            seed=self.seed,
            minutes=round(self.elapsed() / 60, 2),
            diverged_in_epoch=self.last_finite.diverged,
        )


class LastFinite:
    """The weights of a module when they were last known to be finite."""

    def __init__(self, module: nn.Module) -> None:
        self.module = module
        self.diverged: int | None = None
        self.weights = self._copy()

    def _copy(self) -> dict[str, Tensor]:
        return {name: value.detach().clone() for name, value in self.module.state_dict().items()}

    def keep(self) -> bool:
        """Keep the present weights if they are finite; whether they are."""
        present = self._copy()
        finite = all(bool(value.isfinite().all()) for value in present.values())
        if finite:
            self.weights = present
        return finite

    def state_dict(self) -> dict[str, Any]:
        return {"weights": self.weights, "diverged": self.diverged}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self.weights, self.diverged = state["weights"], state["diverged"]
