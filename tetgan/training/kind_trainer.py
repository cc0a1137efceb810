"""The loop of every kind of model that has a learner."""

import logging
import math
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Int
from torch import Tensor, nn

from tetgan.fields.samplings import open_sampling
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.models.kinds import kind_of
from tetgan.models.options import KindOptions
from tetgan.models.registry import save_generator
from tetgan.training.checkpoint import run_digest
from tetgan.training.common import CommonTraining
from tetgan.training.kind_learner import KindLearner
from tetgan.training.loop import WITHOUT_EFFECT, TrainingLoop, step_draws
from tetgan.training.runlog import Losses
from tetgan.training.stores import open_training

log = logging.getLogger(__name__)


def train_learner(
    index: Path, options: KindOptions, training: CommonTraining, seed: int, folder: Path
) -> None:
    """Train the learner of a model's kind on the training split of an index.

    One that diverges is no error: the weights of the last epoch without infinities are kept, and
    `options.json` says in which epoch it happened.

    Args:
        index: `index.json` of the fields or the sampling that the model names.
        folder: receives `options.json`, `weights.safetensors`, `log.csv`, `events/` and `checkpoint.pt`.

    Raises:
        UserError: the index does not hold what the model learns from.
    """
    kind = kind_of(options)
    store = open_training(index) if kind.sampling is None else open_sampling(index, kind.sampling["kind"])
    learner = kind.load("learner")(options, training, store, seed)
    hierarchy = getattr(store, "hierarchy", None)
    KindTrainer(learner, options, training, seed, folder, hierarchy=hierarchy).run()


class KindTrainer(TrainingLoop):
    """A run of a learner."""

    def __init__(
        self,
        learner: KindLearner,
        options: KindOptions,
        training: CommonTraining,
        seed: int,
        folder: Path,
        *,
        hierarchy: GridHierarchy | None = None,
    ) -> None:
        self.learner, self.options, self.training, self.hierarchy = learner, options, training, hierarchy
        self.columns = ("epoch", "seconds", *learner.losses)
        self.last_finite = LastFinite(learner.generator)
        own = options.model_dump(exclude={"training", "meshing"})
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
            self.hierarchy,
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
