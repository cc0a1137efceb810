"""Training of TetGAN: data, schedules, validation and pictures."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Int
from torch import Tensor

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
from tetgan.models.generator import FieldGenerator
from tetgan.models.iou import occupancy_iou
from tetgan.models.sampling import generate_fields, reconstruct_fields
from tetgan.rendering.raycast import render_mesh
from tetgan.rendering.sheet import contact_sheet, save_image
from tetgan.training.checkpoint import run_digest
from tetgan.training.data import open_fields
from tetgan.training.learner import Learner
from tetgan.training.log import Losses
from tetgan.training.loop import step_draws
from tetgan.training.processes import as_in_first, own_device, own_rows, process_place

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


SOME_SHAPES = 1024  # from which the latent head starts and the prior is fitted, at most


LOSSES = (
    *("learning_rate", "kl_weight", "occupancy_loss", "displacement_loss", "kl"),
    *("local_gap", "local_penalty", "global_gap", "global_penalty", "adversarial_loss", "adversarial_ratio"),
    *("validation_iou", "validation_occupancy_loss", "validation_displacement_loss"),
)


class TetganRun(Learner):
    """TetGAN's data, schedules and pictures, around its networks and their steps.

    Several processes may share the batches; the fields of the next ones are read ahead.
    """

    generator: TetganGenerator

    losses = LOSSES

    def __init__(
        self, options: TetganOptions, training: TetganTraining, store: FieldStore, seed: int
    ) -> None:
        self.store, self.training, self.seed = store, training, seed
        self.epochs, self.batch_size = training.epochs, training.batch_size
        device = own_device(training.device)
        self.data, self.held_out = (
            open_fields(store, split, device, training.fields) for split in ("train", "validation")
        )
        self.shapes = len(self.data)
        self.data_digest = run_digest(grid=store.hierarchy.digest, train=self.data.digest)
        operator = vertex_operator(store.hierarchy.finest)
        self.learner = TetganLearner(
            options,
            training,
            store.hierarchy,
            operator,
            mu=store.mu / store.max_displacement,
            seed=seed,
            device=device,
        )
        self.generator = self.learner.generator
        self.steps_per_epoch = math.ceil(self.shapes / self.batch_size)
        self.steps = self.epochs * self.steps_per_epoch
        self.bypass = bypass_steps(self.steps, training)
        self.taken = 0  # steps

    def batches(self, order: Int[Tensor, "N"]) -> Sequence[Int[Tensor, "_B"]]:
        """As in the official code: full batches, and what is left over."""
        return order.split(self.batch_size)

    def start(self, step: int, rows: Callable[[int], Int[Tensor, "_B"]]) -> None:
        """Read this process's part of every batch from that step on."""
        self.taken = step
        batches = chain.from_iterable(self._batches(ahead, rows(ahead)) for ahead in range(step, self.steps))
        self.fields = self.data.batches(batch[own_rows(len(batch))] for batch in batches)

    def _batches(self, step: int, rows: Int[Tensor, "B"]) -> Iterator[Int[Tensor, "_B"]]:
        """The shapes of the autoencoder's batch of a step, then those of the critics' batches."""
        yield rows
        if adversarial_step_due(step, self.steps, self.training):
            draws = step_draws(self.seed, self.steps + self.epochs + step)
            for _ in range(self.training.critic_steps):
                yield torch.randint(self.shapes, (self.batch_size,), generator=draws)

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """An autoencoder step, and an adversarial round where one is due."""
        self.learner.set_rate(rate_factor(step / self.steps, self.training.decay))
        field = next(self.fields)
        if step < self.bypass:
            losses = self.learner.bypass_step(field, draws, of=len(rows))
        else:
            if step == self.bypass > 0:
                self.learner.start_head(self._some_batches())
                as_in_first(self.generator)
            weight = kl_weight(step * self.batch_size, self.training)
            losses = self.learner.autoencoder_step(field, weight, draws, of=len(rows))
        if adversarial_step_due(step, self.steps, self.training):
            losses |= self._adversarial_round(draws)
        self.taken = step + 1
        return losses

    def _adversarial_round(self, draws: torch.Generator) -> Losses:
        losses: Losses = {}
        for _ in range(self.training.critic_steps):
            losses |= self.learner.critic_step(next(self.fields), draws, of=self.batch_size)
        return losses | self.learner.adversarial_step(self.batch_size, draws)

    def _some_batches(self) -> Iterator[Tensor]:
        """Training shapes enough to know how features or codes are distributed."""
        rows = torch.randperm(self.shapes, generator=step_draws(self.seed, self.taken))[:SOME_SHAPES]
        return self.data.batches(rows.split(self.batch_size))

    def averaged(self) -> AbstractContextManager[None]:
        return self.learner.average.applied()

    @property
    def has_latents(self) -> bool:
        """During the bypass there is no latent to decode from."""
        return self.taken > self.bypass

    @torch.no_grad()
    def validate(self) -> dict[str, float]:
        """Means over the split: occupancy IoU, and unweighted losses of the posterior mean's decoding."""
        if not self.has_latents or not len(self.held_out):
            return {}
        sums = np.zeros(3)
        for field in self.held_out.batches(torch.arange(len(self.held_out)).split(self.batch_size)):
            decoded = self.generator.decode(self.generator.encode(field))
            iou = occupancy_iou((decoded[..., 0] > 0).cpu().numpy(), (field[..., 0] > 0.5).cpu().numpy())
            pair = self.generator.in_range(decoded), self.generator.in_range(field)
            losses = occupancy_loss(decoded, field, 1.0), displacement_loss(*pair, self.learner.vertices)
            sums += [iou.sum(), *(len(field) * float(loss) for loss in losses)]
        return dict(zip(LOSSES[-3:], (sums / len(self.held_out)).tolist(), strict=True))

    def finish_epoch(self, epoch: int, last: bool, folder: Path) -> dict[str, float]:
        """Rates after the epoch; a picture, and the prior fitted, where that is due."""
        training = self.training
        due = self.has_latents and (last or epoch % training.picture_every == 0)
        if due and process_place() == 0:
            with self.averaged():
                self.learner.fit_prior(self._some_batches())
                draw_decoded(folder / f"decoded_{epoch:04d}.png", self.generator, self.store, training.device)
        critics = self.taken + self.steps_per_epoch > first_adversarial_step(self.steps, training)
        if self.has_latents and critics:
            # For the fields that the critics of the next epoch see.
            self.learner.fit_prior(self._some_batches())
            as_in_first(self.generator)
        return {
            "learning_rate": training.learning_rate * rate_factor(self.taken / self.steps, training.decay),
            "kl_weight": kl_weight(self.taken * self.batch_size, training),
        }

    def finish(self) -> None:
        """Fit the prior to the codes of the weights that are kept."""
        self.learner.fit_prior(self._some_batches())

    def parts(self) -> dict[str, Any]:
        return self.learner.parts()
