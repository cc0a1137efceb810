"""Training loop of every model; a killed run resumes to the same weights."""

import logging
import math
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Int
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from torch import Tensor, nn

from tetgan.fields.samplings import open_sampling
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.models.files import save_generator
from tetgan.models.method import MethodOptions
from tetgan.models.registry import method_of
from tetgan.training.checkpoint import load_checkpoint, run_digest, save_checkpoint
from tetgan.training.data import open_training
from tetgan.training.learner import Learner
from tetgan.training.log import COLUMNS, Losses, RunLog
from tetgan.training.options import CommonTraining
from tetgan.training.processes import process_place

log = logging.getLogger(__name__)


# Options that may change between a run and its resumption: the weights depend on them by rounding at most.
WITHOUT_EFFECT = {
    *("device", "accumulate", "checkpointing", "fields"),
    *("validate_every", "picture_every", "checkpoint_seconds"),
}


class TrainingLoop(ABC):
    """One run. A subclass says what a step of its model is, what a checkpoint must hold, and how it ends.

    A step depends on nothing but those parts and the generator that it is given, so a run that was killed
    goes on from its checkpoint as if nothing had been. Of several processes that train together each runs
    this loop, and the first alone writes.
    """

    columns: tuple[str, ...] = COLUMNS
    """Of `log.csv`: the epoch, whatever `finish_epoch` adds, and means of the losses of its steps."""

    def __init__(
        self,
        folder: Path,
        seed: int,
        *,
        epochs: int,
        steps_per_epoch: int,
        checkpoint_seconds: float,
        digests: dict[str, str],
    ) -> None:
        """`digests` tell this run from every other, so that no other's checkpoint is resumed."""
        self.folder, self.seed, self.digests = folder, seed, digests
        self.steps_per_epoch, self.steps = steps_per_epoch, steps_per_epoch * epochs
        self.checkpoint_seconds = checkpoint_seconds
        self.step, self.seconds = 0, 0.0

    @abstractmethod
    def take_step(self, draws: torch.Generator) -> Losses:
        """Train on one batch; all random numbers come from `draws`."""

    @abstractmethod
    def finish_epoch(self, epoch: int) -> None:
        """Close the epoch's row of the log. May lower `steps` to `step` to end the run."""

    @abstractmethod
    def parts(self) -> dict[str, Any]:
        """Objects with a state on which the next step depends, by name."""

    @abstractmethod
    def save(self) -> None:
        """Write the trained model."""

    def run(self) -> None:
        """Train to the end, from the checkpoint if there is one of this very run."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self.first = process_place() == 0
        self.log = RunLog(self.folder, self.columns, writes=self.first)
        self._resume()
        self._saved = self._started = time.monotonic()
        with _deterministic(), self._progress() as advance:
            while self.step < self.steps:
                self._take_step()
                advance()
                if self.step % self.steps_per_epoch == 0:
                    self.finish_epoch(self.step // self.steps_per_epoch)
                if self.first and time.monotonic() - self._saved >= self.checkpoint_seconds:
                    self._checkpoint()
        if self.first:
            self.save()
            self._checkpoint(finished=True)
        self.log.close()

    def elapsed(self) -> float:
        """Seconds of training, those before a resumption included."""
        return self.seconds + time.monotonic() - self._started

    def _take_step(self) -> None:
        self.log.add(self.take_step(step_draws(self.seed, self.step)))
        self.step += 1

    def _resume(self) -> None:
        state = load_checkpoint(self.folder, self.digests)
        if state is None:
            return
        for name, part in self.parts().items():
            part.load_state_dict(state["parts"][name])
        self.log.restore(state["log"])
        self.step, self.seconds = state["step"], state["seconds"]
        log.info("resumed at step %d of %d", self.step, self.steps)

    def _checkpoint(self, finished: bool = False) -> None:
        parts = {name: part.state_dict() for name, part in self.parts().items()}
        state: dict[str, Any] = {"step": self.step, "seconds": self.elapsed(), "finished": finished}
        save_checkpoint(self.folder, self.digests, state | {"parts": parts, "log": self.log.state()})
        self._saved = time.monotonic()

    @contextmanager
    def _progress(self) -> Iterator[Any]:
        columns = TextColumn("training"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
        with Progress(*columns, console=Console(stderr=True, quiet=not self.first)) as bar:
            task = bar.add_task("training", total=self.steps, completed=self.step)
            yield lambda: bar.advance(task)


def step_draws(seed: int, step: int) -> torch.Generator:
    """The random numbers of one step: a function of seed and step, so a resumed run draws the same."""
    state = np.random.SeedSequence([seed, step]).generate_state(1, np.uint64)
    return torch.Generator().manual_seed(int(state[0] >> np.uint64(1)))


@contextmanager
def _deterministic() -> Iterator[None]:
    """Algorithms whose result does not depend on timing, where PyTorch has them."""
    before = torch.are_deterministic_algorithms_enabled()
    torch.use_deterministic_algorithms(True, warn_only=True)
    try:
        yield
    finally:
        torch.use_deterministic_algorithms(before)


def train_learner(
    index: Path, options: MethodOptions, training: CommonTraining, seed: int, folder: Path
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
    kind = method_of(options)
    store = open_training(index) if kind.sampling is None else open_sampling(index, kind.sampling["kind"])
    learner = kind.load("learner")(options, training, store, seed)
    hierarchy = getattr(store, "hierarchy", None)
    KindTrainer(learner, options, training, seed, folder, hierarchy=hierarchy).run()


class KindTrainer(TrainingLoop):
    """A run of a learner."""

    def __init__(
        self,
        learner: Learner,
        options: MethodOptions,
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
