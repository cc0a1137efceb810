"""The loop that trains every model. Killed and run again, it ends with the same weights."""

import logging
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import torch
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from tetgan.training.checkpoint import load_checkpoint, save_checkpoint
from tetgan.training.processes import process_place
from tetgan.training.runlog import COLUMNS, Losses, RunLog

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
        """What the next step depends on: objects with a state, by name."""

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
