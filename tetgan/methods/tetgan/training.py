"""Training of TetGAN: data, schedules, validation and pictures."""

import math
from collections.abc import Iterator
from functools import cached_property
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from tetgan.errors import UserError
from tetgan.fields.field import Field, VertexField, vertex_operator
from tetgan.fields.store import FieldStore
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.methods.tetgan.objectives import displacement_loss, occupancy_loss
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.methods.tetgan.schedule import (
    adversarial_step_due,
    bypass_steps,
    first_adversarial_step,
    kl_weight,
    rate_factor,
)
from tetgan.models.files import save_generator
from tetgan.models.generator import FieldGenerator
from tetgan.models.iou import occupancy_iou
from tetgan.models.sampling import generate_fields, reconstruct_fields
from tetgan.nn.device import pick_device
from tetgan.nn.rows import RowMap
from tetgan.rendering.raycast import render_mesh
from tetgan.rendering.sheet import contact_sheet, save_image
from tetgan.training.checkpoint import run_digest
from tetgan.training.data import FieldData, open_fields, open_training
from tetgan.training.log import Losses
from tetgan.training.loop import WITHOUT_EFFECT, TrainingLoop, step_draws
from tetgan.training.processes import as_in_first, own_rows, process_group

SHAPES = 8

SIZE = (220, 220)


def draw_decoded(path: Path, generator: FieldGenerator, store: FieldStore, device: str) -> None:
    """Validation shapes, their reconstructions, and samples of seed 0: three rows of eight."""
    ids = store.ids("validation")[:SHAPES]
    originals = (store.read(shape_id) for shape_id in ids)
    reconstructions = (field for _, field, _ in reconstruct_fields(generator, store, ids, device=device))
    samples = generate_fields(generator, store, SHAPES, seed=0, device=device)
    rows = {"original": originals, "decoded": reconstructions, "sampled": samples}
    images = list(chain.from_iterable(_row(fields, store) for fields in rows.values()))
    save_image(path, contact_sheet(images, SHAPES, row_titles=list(rows)))


def _row(fields: Iterator[Field | VertexField], store: FieldStore) -> Iterator[np.ndarray]:
    """Pictures of the fields, then white up to the length of a row."""
    blank = np.full((SIZE[1], SIZE[0], 3), 255, dtype=np.uint8)
    grid = store.hierarchy.finest
    operator, options = vertex_operator(grid), MeshingOptions.parse({})
    solids = (build_solid(field, grid, operator, store.mu, options, smoothing=True) for field in fields)
    pictures = (render_mesh(solid.vertices, solid.faces, size=SIZE) for solid in solids)
    return islice(chain(pictures, (blank for _ in range(SHAPES))), SHAPES)


@torch.no_grad()
def validate(
    generator: TetganGenerator, vertices: RowMap, data: FieldData, batch_size: int
) -> dict[str, float]:
    """Means over the split: occupancy IoU and the unweighted losses of the posterior mean's decoding."""
    sums = np.zeros(3)
    for field in data.batches(torch.arange(len(data)).split(batch_size)):
        decoded = generator.decode(generator.encode(field))
        iou = occupancy_iou((decoded[..., 0] > 0).cpu().numpy(), (field[..., 0] > 0.5).cpu().numpy())
        compared = displacement_loss(generator.in_range(decoded), generator.in_range(field), vertices)
        losses = occupancy_loss(decoded, field, 1.0), compared
        sums += [iou.sum(), *(len(field) * float(loss) for loss in losses)]
    names = ("validation_iou", "validation_occupancy_loss", "validation_displacement_loss")
    return {name: float(value) for name, value in zip(names, sums / len(data), strict=True)}


SOME_SHAPES = 1024  # from which the latent head starts and the prior is fitted, at most


def train_tetgan(
    index: Path, options: TetganOptions, training: TetganTraining, seed: int, folder: Path
) -> None:
    """Train a TetGAN; the folder receives `decoded_*.png` too.

    Raises:
        UserError: there are no training shapes, or the training diverges.
    """
    with process_group(training.device) as device:
        Trainer(open_training(index), options, training, seed, folder, device=device).run()


class Trainer(TrainingLoop):
    """A run of TetGAN: its data, schedules and pictures."""

    def __init__(
        self,
        store: FieldStore,
        options: TetganOptions,
        training: TetganTraining,
        seed: int,
        folder: Path,
        *,
        device: torch.device | None = None,
    ) -> None:
        self.store, self.options, self.training = store, options, training
        self.device = device or pick_device(training.device)
        self.data, self.held_out = (
            open_fields(store, split, self.device, training.fields) for split in ("train", "validation")
        )
        operator = vertex_operator(store.hierarchy.finest)
        self.learner = TetganLearner(
            options,
            training,
            store.hierarchy,
            operator,
            mu=store.mu / store.max_displacement,
            seed=seed,
            device=self.device,
        )
        digests = {
            "options": run_digest(
                model=options.model_dump(exclude={"training", "meshing"}),
                training=training.model_dump(exclude=WITHOUT_EFFECT),
                seed=seed,
            ),
            "data": run_digest(grid=store.hierarchy.digest, train=self.data.digest),
        }
        super().__init__(
            folder,
            seed,
            epochs=training.epochs,
            steps_per_epoch=math.ceil(len(self.data) / training.batch_size),
            checkpoint_seconds=training.checkpoint_seconds,
            digests=digests,
        )
        self.bypass = bypass_steps(self.steps, training)

    def take_step(self, draws: torch.Generator) -> Losses:
        """An autoencoder step, and an adversarial round where one is due."""
        self.learner.set_rate(rate_factor(self.step / self.steps, self.training))
        field, shapes = next(self.batches), len(self._epoch_rows(self.step))
        if self.step < self.bypass:
            losses = self.learner.bypass_step(field, draws, of=shapes)
        else:
            if self.step == self.bypass > 0:
                self.learner.start_head(self._some_batches())
                as_in_first(self.learner.generator)
            weight = kl_weight(self.step * self.training.batch_size, self.training)
            losses = self.learner.autoencoder_step(field, weight, draws, of=shapes)
        if adversarial_step_due(self.step, self.steps, self.training):
            losses |= self._adversarial_round(draws)
        return losses

    @cached_property
    def batches(self) -> Iterator[Tensor]:
        """Fields of every batch from the first step of this process on, this process's part of each."""
        rows = chain.from_iterable(map(self._rows, range(self.step, self.steps)))
        return self.data.batches(batch[own_rows(len(batch))] for batch in rows)

    def _rows(self, step: int) -> Iterator[Tensor]:
        """The shapes of the autoencoder's batch of a step, then those of the critics' batches."""
        yield self._epoch_rows(step)
        if adversarial_step_due(step, self.steps, self.training):
            draws = step_draws(self.seed, self.steps + self.training.epochs + step)
            for _ in range(self.training.critic_steps):
                yield torch.randint(len(self.data), (self.training.batch_size,), generator=draws)

    def _epoch_rows(self, step: int) -> Tensor:
        """The shapes of a step in its epoch; each epoch has an order of its own."""
        epoch, place = divmod(step, self.steps_per_epoch)
        order = torch.randperm(len(self.data), generator=step_draws(self.seed, self.steps + epoch))
        size = self.training.batch_size
        return order[place * size : (place + 1) * size]

    def _some_batches(self) -> Iterator[Tensor]:
        """Training shapes enough to know how features or codes are distributed."""
        rows = torch.randperm(len(self.data), generator=step_draws(self.seed, self.step))[:SOME_SHAPES]
        return self.data.batches(rows.split(self.training.batch_size))

    def _adversarial_round(self, draws: torch.Generator) -> Losses:
        size = self.training.batch_size
        losses: Losses = {}
        for _ in range(self.training.critic_steps):
            losses |= self.learner.critic_step(next(self.batches), draws, of=size)
        return losses | self.learner.adversarial_step(size, draws)

    def finish_epoch(self, epoch: int) -> None:
        """Validate, draw and fit the prior where that is due.

        Raises:
            UserError: the training diverges.
        """
        training, last = self.training, self.step == self.steps
        further = {
            "seconds": self.elapsed(),
            "learning_rate": training.learning_rate * rate_factor(self.step / self.steps, training),
            "kl_weight": kl_weight(self.step * training.batch_size, training),
        }
        whole = self.step > self.bypass  # before, there is no latent to decode from
        with self.learner.average.applied():
            if (
                self.first
                and whole
                and len(self.held_out) > 0
                and (last or epoch % training.validate_every == 0)
            ):
                further |= self._validate()
            if self.first and whole and (last or epoch % training.picture_every == 0):
                self.learner.fit_prior(self._some_batches())
                picture = self.folder / f"decoded_{epoch:04d}.png"
                draw_decoded(picture, self.learner.generator, self.store, training.device)
        if whole and self.step + self.steps_per_epoch > first_adversarial_step(self.steps, training):
            self.learner.fit_prior(self._some_batches())  # for the fields that the critics of this epoch see
            as_in_first(self.learner.generator)
        row = self.log.finish_epoch(epoch, further)
        if not math.isfinite(row["occupancy_loss"]):
            raise UserError(f"{self.folder}: training diverged in epoch {epoch}; lower learning_rate")

    def _validate(self) -> dict[str, float]:
        learner = self.learner
        return validate(learner.generator, learner.vertices, self.held_out, self.training.batch_size)

    def parts(self) -> dict[str, Any]:
        return self.learner.parts()

    def save(self) -> None:
        """The averaged weights, with the prior fitted to them."""
        with self.learner.average.applied():
            self.learner.fit_prior(self._some_batches())
            save_generator(
                self.folder,
                self.learner.generator,
                self.options,
                self.store.hierarchy,
                training=self.training.model_dump(mode="json"),
                seed=self.seed,
                minutes=round(self.elapsed() / 60, 2),
            )
