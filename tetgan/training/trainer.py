"""Stage: fields in, a trained model out. Killed and run again, it ends with the same weights."""

import logging
import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import torch
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from torch import Tensor

from tetgan.errors import UserError
from tetgan.fields.store import FieldStore
from tetgan.fields.vertices import vertex_operator
from tetgan.models.baselines.pca import PcaGenerator
from tetgan.models.options import ModelOptions, PcaOptions, TetganOptions
from tetgan.models.registry import build_generator, save_generator
from tetgan.nn.device import pick_device
from tetgan.training.checkpoint import load_checkpoint, run_digest, save_checkpoint
from tetgan.training.data import FieldData
from tetgan.training.learner import Learner, Losses, step_draws
from tetgan.training.options import TrainingOptions
from tetgan.training.pictures import draw_decoded
from tetgan.training.runlog import RunLog
from tetgan.training.schedule import (
    adversarial_step_due,
    bypass_steps,
    first_adversarial_step,
    kl_weight,
    rate_factor,
)
from tetgan.training.validation import validate

log = logging.getLogger(__name__)

SOME_SHAPES = 1024  # from which the latent head starts and the prior is fitted, at most
# Options that may change between a run and its resumption: the weights do not depend on them.
WITHOUT_EFFECT = {"device", "validate_every", "picture_every", "checkpoint_seconds"}


def train_model(
    index: Path,
    options: ModelOptions,  # type: ignore[valid-type]
    training: TrainingOptions,
    seed: int,
    out_folder: Path,
) -> None:
    """Train a model on the training split of an index of fields.

    Args:
        index: `index.json` of the fields.
        out_folder: receives `options.json` and `weights.safetensors`; for TetGAN also `log.csv`, `events/`
            for TensorBoard, `decoded_*.png`, and `checkpoint.pt`, from which a killed run goes on.

    Raises:
        UserError: there are no training shapes, or the training diverges.
    """
    store = FieldStore.open(index)
    if not store.ids("train"):
        raise UserError(f"{index}: no training shapes; add shapes to the source")
    if isinstance(options, TetganOptions):
        Trainer(store, options, training, seed, out_folder).run()
        return
    generator = build_generator(options, store.hierarchy)
    if isinstance(options, PcaOptions):
        assert isinstance(generator, PcaGenerator)
        data = FieldData(store, "train")
        generator.fit(data.tets)
    save_generator(out_folder, generator, options, store.hierarchy)


class Trainer:
    """One run: the loop over steps, its log, checkpoints and pictures."""

    def __init__(
        self, store: FieldStore, options: TetganOptions, training: TrainingOptions, seed: int, folder: Path
    ) -> None:
        self.store, self.options, self.training = store, options, training
        self.seed, self.folder = seed, folder
        self.device = pick_device(training.device)
        self.data, self.held_out = FieldData(store, "train"), FieldData(store, "validation")
        operator = vertex_operator(store.hierarchy.finest)
        self.learner = Learner(options, training, store.hierarchy, operator, seed=seed, device=self.device)
        self.steps_per_epoch = math.ceil(len(self.data) / training.batch_size)
        self.steps = self.steps_per_epoch * training.epochs
        self.bypass = bypass_steps(self.steps, training)
        self.step, self.seconds = 0, 0.0
        self.digests = {
            "options": run_digest(
                model=options.model_dump(exclude={"training"}),
                training=training.model_dump(exclude=WITHOUT_EFFECT),
                seed=seed,
            ),
            "data": run_digest(grid=store.hierarchy.digest, train=self.data.digest),
        }

    def run(self) -> None:
        """Train to the end, from the checkpoint if there is one of this very run."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self.log = RunLog(self.folder)
        self._resume()
        self._saved = self._started = time.monotonic()
        with _deterministic(), self._progress() as advance:
            while self.step < self.steps:
                self._take_step()
                advance()
                if self.step % self.steps_per_epoch == 0:
                    self._finish_epoch(self.step // self.steps_per_epoch)
                if time.monotonic() - self._saved >= self.training.checkpoint_seconds:
                    self._checkpoint()
        self._finish()

    def _take_step(self) -> None:
        """An autoencoder step, and an adversarial round where one is due."""
        draws = step_draws(self.seed, self.step)
        self.learner.set_rate(rate_factor(self.step / self.steps, self.training))
        if self.step < self.bypass:
            losses = self.learner.bypass_step(self._batch(), draws)
        else:
            if self.step == self.bypass > 0:
                self.learner.start_head(self._some_batches())
            weight = kl_weight(self.step * self.training.batch_size, self.training)
            losses = self.learner.autoencoder_step(self._batch(), weight, draws)
        if adversarial_step_due(self.step, self.steps, self.training):
            losses |= self._adversarial_round(draws)
        self.log.add(losses)
        self.step += 1

    def _batch(self) -> Tensor:
        """The fields of this step; each epoch has an order of its own."""
        epoch, place = divmod(self.step, self.steps_per_epoch)
        order = torch.randperm(len(self.data), generator=step_draws(self.seed, self.steps + epoch))
        size = self.training.batch_size
        return self.data.batch(order[place * size : (place + 1) * size], self.device)

    def _some_batches(self) -> Iterator[Tensor]:
        """Training shapes enough to know how features or codes are distributed."""
        rows = torch.randperm(len(self.data), generator=step_draws(self.seed, self.step))[:SOME_SHAPES]
        return (self.data.batch(batch, self.device) for batch in rows.split(self.training.batch_size))

    def _adversarial_round(self, draws: torch.Generator) -> Losses:
        size = self.training.batch_size
        losses: Losses = {}
        for _ in range(self.training.critic_steps):
            rows = torch.randint(len(self.data), (size,), generator=draws)
            losses |= self.learner.critic_step(self.data.batch(rows, self.device), draws)
        return losses | self.learner.adversarial_step(size, draws)

    def _finish_epoch(self, epoch: int) -> None:
        training, last = self.training, self.step == self.steps
        further = {
            "seconds": self._elapsed(),
            "learning_rate": training.learning_rate * rate_factor(self.step / self.steps, training),
            "kl_weight": kl_weight(self.step * training.batch_size, training),
        }
        whole = self.step > self.bypass  # before, there is no latent to decode from
        with self.learner.average.applied():
            if whole and len(self.held_out) > 0 and (last or epoch % training.validate_every == 0):
                further |= self._validate()
            if whole and (last or epoch % training.picture_every == 0):
                self.learner.fit_prior(self._some_batches())
                picture = self.folder / f"decoded_{epoch:04d}.png"
                draw_decoded(picture, self.learner.generator, self.store, training.device)
        if whole and self.step + self.steps_per_epoch > first_adversarial_step(self.steps, training):
            self.learner.fit_prior(self._some_batches())  # for the fields that the critics of this epoch see
        row = self.log.finish_epoch(epoch, further)
        if not math.isfinite(row["occupancy_loss"]):
            raise UserError(f"{self.folder}: training diverged in epoch {epoch}; lower learning_rate")

    def _validate(self) -> dict[str, float]:
        learner = self.learner
        return validate(
            learner.generator, learner.vertices, self.held_out, self.training.batch_size, self.device
        )

    def _resume(self) -> None:
        state = load_checkpoint(self.folder, self.digests)
        if state is None:
            return
        for name, part in self.learner.parts().items():
            part.load_state_dict(state["parts"][name])
        self.log.restore(state["log"])
        self.step, self.seconds = state["step"], state["seconds"]
        log.info("resumed at step %d of %d", self.step, self.steps)

    def _checkpoint(self, finished: bool = False) -> None:
        parts = {name: part.state_dict() for name, part in self.learner.parts().items()}
        state: dict[str, Any] = {"step": self.step, "seconds": self._elapsed(), "finished": finished}
        save_checkpoint(self.folder, self.digests, state | {"parts": parts, "log": self.log.state()})
        self._saved = time.monotonic()

    def _finish(self) -> None:
        with self.learner.average.applied():
            self.learner.fit_prior(self._some_batches())
            save_generator(
                self.folder,
                self.learner.generator,
                self.options,
                self.store.hierarchy,
                training=self.training.model_dump(mode="json"),
                seed=self.seed,
                minutes=round(self._elapsed() / 60, 2),
            )
        self._checkpoint(finished=True)
        self.log.close()

    def _elapsed(self) -> float:
        """Seconds of training, those before a resumption included."""
        return self.seconds + time.monotonic() - self._started

    @contextmanager
    def _progress(self) -> Iterator[Any]:
        columns = TextColumn("training"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
        with Progress(*columns, console=Console(stderr=True)) as bar:
            task = bar.add_task("training", total=self.steps, completed=self.step)
            yield lambda: bar.advance(task)


@contextmanager
def _deterministic() -> Iterator[None]:
    """Algorithms whose result does not depend on timing, where PyTorch has them."""
    before = torch.are_deterministic_algorithms_enabled()
    torch.use_deterministic_algorithms(True, warn_only=True)
    try:
        yield
    finally:
        torch.use_deterministic_algorithms(before)
