"""The training loop of every method. Killed and run again, it ends with the same weights."""

import logging
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Int
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from torch import Tensor, nn

from tetgan.errors import UserError
from tetgan.training.checkpoint import load_checkpoint, run_digest, save_checkpoint
from tetgan.training.learner import Learner
from tetgan.training.log import RunLog
from tetgan.training.processes import process_place

log = logging.getLogger(__name__)

MEMORY: Any = torch.utils.deterministic  # its types do not know what it holds


class TrainingLoop:
    """One run of a learner.

    A step depends on nothing but the learner's parts and the generator that it is given, so a run that was
    killed goes on from its checkpoint as if nothing had been. Of several processes that train together each
    runs this loop, and the first alone writes.

    One that diverges is no error, unless it does so in its first epoch: the weights of the last epoch without
    infinities are saved.
    """

    def __init__(
        self,
        learner: Learner,
        folder: Path,
        seed: int,
        *,
        options: Mapping[str, Any],
        further: Mapping[str, str] | None = None,
        validate_every: int = 1,
        checkpoint_seconds: float = 120.0,
    ) -> None:
        """Prepare a run.

        Args:
            folder: receives `log.csv`, `events/`, and `checkpoint.pt`.
            options: everything, beside seed and data, that the weights depend on, as plain values: a
                checkpoint of a run with others is not resumed.
            further: digests of what else they depend on, by name.
            validate_every: epochs between two validations; the last epoch has one in any case.
            checkpoint_seconds: least time between two checkpoints.
        """
        self.learner, self.folder, self.seed = learner, folder, seed
        self.digests = {
            "options": run_digest(**options, seed=seed),
            "data": learner.data_digest,
            **(further or {}),
        }
        self.validate_every, self.checkpoint_seconds = validate_every, checkpoint_seconds
        self.steps_per_epoch = len(learner.batches(torch.arange(learner.shapes)))
        self.steps = self.steps_per_epoch * learner.epochs
        self.step, self.seconds = 0, 0.0
        self.last_finite = LastFinite(learner.generator)

    def run(self, save: Callable[..., None]) -> None:
        """Train to the end, from the checkpoint if there is one of this very run.

        Args:
            save: writes the model, whose weights the learner's generator has by then; it is called with
                `minutes` and `diverged_in_epoch`, None for a run that did not.

        Raises:
            UserError: the training diverges before anything is learnt.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        self.first = process_place() == 0
        self.log = RunLog(self.folder, ("epoch", "seconds", *self.learner.losses), writes=self.first)
        self._resume()
        self._saved = self._started = time.monotonic()
        self.learner.start(self.step, self.rows)
        with _deterministic(), self._progress() as advance:
            while self.step < self.steps and self.last_finite.diverged is None:
                self._take_step()
                advance()
                if self.step % self.steps_per_epoch == 0:
                    self._finish_epoch(self.step // self.steps_per_epoch)
                if self.first and time.monotonic() - self._saved >= self.checkpoint_seconds:
                    self._checkpoint()
        if self.first:
            self._save(save)
            self._checkpoint(finished=True)
        self.log.close()

    def rows(self, step: int) -> Int[Tensor, "B"]:
        """The shapes of a step; each epoch has an order of its own."""
        epoch, place = divmod(step, self.steps_per_epoch)
        order = torch.randperm(self.learner.shapes, generator=step_draws(self.seed, self.steps + epoch))
        return self.learner.batches(order)[place]

    def _take_step(self) -> None:
        draws, epoch = step_draws(self.seed, self.step), self.step / self.steps_per_epoch
        self.log.add(self.learner.take_step(self.rows(self.step), self.step, epoch, draws))
        self.step += 1

    def _finish_epoch(self, epoch: int) -> None:
        """Close the epoch's row of the log, with a validation where that is due; or find that it diverged.

        Raises:
            UserError: it did in the first epoch.
        """
        learner, last = self.learner, self.step == self.steps
        further: dict[str, float] = {"seconds": self._elapsed()}
        with learner.averaged():
            finite = self.log.is_finite() and self.last_finite.keep()
            if finite and self.first and (last or epoch % self.validate_every == 0):
                further |= learner.validate()
        if finite:
            further |= learner.finish_epoch(epoch, last, self.folder)
        self.log.finish_epoch(epoch, further)
        if finite:
            return
        if epoch == 1:
            raise UserError(f"{self.folder}: training diverged in its first epoch; lower learning_rate")
        log.warning("diverged in epoch %d; the weights of the epoch before are kept", epoch)
        self.last_finite.diverged = epoch

    def _save(self, save: Callable[..., None]) -> None:
        """Save the last weights, or the last finite ones."""
        self.learner.generator.load_state_dict(self.last_finite.weights)
        self.learner.finish()
        save(minutes=round(self._elapsed() / 60, 2), diverged_in_epoch=self.last_finite.diverged)

    def _elapsed(self) -> float:
        """Seconds of training, those before a resumption included."""
        return self.seconds + time.monotonic() - self._started

    def _parts(self) -> dict[str, Any]:
        return {**self.learner.parts(), "last_finite": self.last_finite}

    def _resume(self) -> None:
        state = load_checkpoint(self.folder, self.digests)
        if state is None:
            return
        for name, part in self._parts().items():
            part.load_state_dict(state["parts"][name])
        self.log.restore(state["log"])
        self.step, self.seconds = state["step"], state["seconds"]
        log.info("resumed at step %d of %d", self.step, self.steps)

    def _checkpoint(self, finished: bool = False) -> None:
        parts = {name: part.state_dict() for name, part in self._parts().items()}
        state: dict[str, Any] = {"step": self.step, "seconds": self._elapsed(), "finished": finished}
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
    """Algorithms whose result does not depend on timing, where PyTorch has them.

    New memory is not filled first, as PyTorch then does: nothing reads what it did not write.
    """
    before = torch.are_deterministic_algorithms_enabled()
    filled = MEMORY.fill_uninitialized_memory
    torch.use_deterministic_algorithms(True, warn_only=True)
    MEMORY.fill_uninitialized_memory = False
    try:
        yield
    finally:
        torch.use_deterministic_algorithms(before)
        MEMORY.fill_uninitialized_memory = filled


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
