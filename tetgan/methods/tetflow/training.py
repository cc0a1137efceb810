"""Training of TetFlow: the autoencoder first, then the flow on the codes of the weights that are kept."""

import hashlib
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from tetgan.fields.dataset import Split
from tetgan.fields.store import FieldStore
from tetgan.methods.tetflow.flow import flow_loss
from tetgan.methods.tetflow.network import TetflowGenerator
from tetgan.methods.tetflow.objectives import TERMS, reconstruction_losses
from tetgan.methods.tetflow.options import TetflowOptions, TetflowTraining
from tetgan.methods.tetflow.shapes import ActiveSets, ActiveShape, collate
from tetgan.models.iou import occupancy_iou
from tetgan.nn.device import pick_device
from tetgan.training.average import WeightAverage
from tetgan.training.checkpoint import run_digest
from tetgan.training.learner import Learner, seeded
from tetgan.training.log import Losses
from tetgan.training.losses import kl_divergence

BETAS = (0.9, 0.99)

LOWEST = 0.005  # share of the step size that is left at the end

SHORT = 10  # times as long as its warmup a stage is at least

VALIDATION_DRAWS = 8  # times and noises of each held-out code


class Codes(NamedTuple):
    """Posteriors of the shapes of a split."""

    mean: Float[Tensor, "N K Z"]
    deviation: Float[Tensor, "N K Z"]


class Stage:
    """Optimiser, course of the step size and running mean of one network."""

    def __init__(self, network: nn.Module, rate: float, steps: int, ema: float, warmup: int) -> None:
        self.network, self.rate, self.steps = network, rate, steps
        self.warmup = max(1, min(warmup, steps // SHORT))
        self.optimizer = torch.optim.Adam(network.parameters(), rate, betas=BETAS)
        self.average = WeightAverage(network, ema)

    def rate_at(self, step: int) -> float:
        """Step size: a linear rise, under half a cosine over the whole stage."""
        rise = min(1.0, (step + 1) / self.warmup)
        return self.rate * rise * (LOWEST + (1 - LOWEST) * (1 + math.cos(math.pi * step / self.steps)) / 2)

    def descend(self, loss: Float[Tensor, ""], step: int, clip: float) -> None:
        """One step of Adam."""
        self.optimizer.param_groups[0]["lr"] = self.rate_at(step)
        self.optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.network.parameters(), clip)
        self.optimizer.step()
        self.average.update()


class TetflowLearner(Learner):
    """Both stages in one run: one folder, one log, one checkpoint.

    An epoch is a pass of the autoencoder over the training shapes; one of the flow has as many steps, each
    on random codes.
    """

    generator: TetflowGenerator

    losses = ("learning_rate", *TERMS, "kl", "flow_loss", "validation_iou", "validation_flow_loss")

    def __init__(
        self, options: TetflowOptions, training: TetflowTraining, store: FieldStore, seed: int
    ) -> None:
        self.training, self.batch_size = training, training.batch_size
        self.epochs = training.epochs + training.flow_epochs
        self.device = pick_device(training.device)
        with seeded(seed):
            self.generator = TetflowGenerator(options, store.hierarchy).to(self.device)
        self.generator.unit.fill_(store.max_displacement)
        self.data, _ = _read_shapes(store, "train", self.generator.sets)
        self.held_out, self.inside = _read_shapes(store, "validation", self.generator.sets)
        self.shapes = len(self.data)
        digest = hashlib.sha256(b"".join(shape.digest for shape in self.data)).hexdigest()
        self.data_digest = run_digest(grid=store.hierarchy.digest, train=digest, unit=store.max_displacement)
        self.steps_per_epoch = len(self.batches(torch.arange(self.shapes)))
        self.first_flow_step = training.epochs * self.steps_per_epoch
        self.autoencoder = Stage(
            self.generator.autoencoder,
            training.learning_rate,
            self.first_flow_step,
            training.ema,
            training.warmup,
        )
        self.flow = Stage(
            self.generator.flow,
            training.flow_learning_rate,
            training.flow_epochs * self.steps_per_epoch,
            training.flow_ema,
            training.warmup,
        )
        self.taken = 0
        self.codes: Codes | None = None

    def start(self, step: int, rows: Any) -> None:
        self.taken = step

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """A step of the autoencoder, or, behind its last one, of the flow."""
        if step < self.first_flow_step:
            losses = self._autoencoder_step([self.data[row] for row in rows.tolist()], step, draws)
        else:
            if step == self.first_flow_step:
                self.generator.autoencoder.load_state_dict(self.autoencoder.average.mean)
                self._standardise()
            losses = self._flow_step(step - self.first_flow_step, draws)
        self.taken = step + 1
        return losses

    def _autoencoder_step(self, shapes: list[ActiveShape], step: int, draws: torch.Generator) -> Losses:
        network, training = self.generator.autoencoder, self.training
        batch = collate(shapes, self.device)
        with self._precision():
            mean, log_variance = network.encoder(batch)
            noise = torch.randn(mean.shape, generator=draws).to(self.device)
            outputs = network.decoder(mean + noise * (0.5 * log_variance).exp(), batch)
        terms = reconstruction_losses(outputs, batch, training.split_weight)
        divergence = kl_divergence(mean, log_variance)
        total = torch.stack([*terms.values(), training.kl_weight * divergence]).sum()
        self.autoencoder.descend(total, step, training.gradient_clip)
        return {name: term.detach() for name, term in (terms | {"kl": divergence}).items()}

    def _precision(self) -> torch.autocast:
        """Inside, products are computed in the format of the options."""
        wanted = self.training.precision == "bf16"
        return torch.autocast(self.device.type, dtype=torch.bfloat16, enabled=wanted)

    def _standardise(self) -> None:
        """Set the mean and the deviation of the training codes, which the flow draws in units of."""
        codes = self._encode(self.data)
        deviation = (codes.mean.var(dim=0, unbiased=False) + codes.deviation.square().mean(dim=0)).sqrt()
        self.generator.mean.copy_(codes.mean.mean(dim=0))
        self.generator.deviation.copy_(deviation)

    @torch.no_grad()
    def _encode(self, shapes: list[ActiveShape]) -> Codes:
        parts = []
        for start in range(0, len(shapes), self.batch_size):
            batch = collate(shapes[start : start + self.batch_size], self.device)
            parts.append(self.generator.autoencoder.encoder(batch))
        mean, log_variance = (torch.cat(part) for part in zip(*parts, strict=True))
        return Codes(mean, (0.5 * log_variance).exp())

    def _flow_step(self, step: int, draws: torch.Generator) -> Losses:
        if self.codes is None:  # those of the kept weights, again after a resumption
            self.codes = self._encode(self.data)
        rows = torch.randint(self.shapes, (self.training.flow_batch_size,), generator=draws)
        with self._precision():
            loss = self._flow_loss(self.codes, rows.to(self.device), draws)
        self.flow.descend(loss, step, self.training.gradient_clip)
        return {"flow_loss": loss.detach()}

    def _flow_loss(self, codes: Codes, rows: Int[Tensor, "B"], draws: torch.Generator) -> Float[Tensor, ""]:
        """On a draw of each posterior, at a logit-normal time (Esser et al. 2024)."""
        shape = len(rows), *self.generator.latent_shape
        spread, noise = (torch.randn(shape, generator=draws).to(self.device) for _ in range(2))
        time = torch.randn(len(rows), generator=draws).sigmoid().to(self.device)
        drawn = codes.mean[rows] + spread * codes.deviation[rows]
        code = (drawn - self.generator.mean) / self.generator.deviation
        return flow_loss(self.generator.flow, code, noise, time)

    @property
    def _flowing(self) -> bool:
        return self.taken > self.first_flow_step

    @contextmanager
    def averaged(self) -> Iterator[None]:
        stage = self.flow if self._flowing else self.autoencoder
        with stage.average.applied():
            yield

    @torch.no_grad()
    def validate(self) -> dict[str, float]:
        """Of held-out shapes: IoU of the field decoded with its own splits; later the flow's loss."""
        if not self.held_out:
            return {}
        if not self._flowing:
            return {"validation_iou": self.mean_iou()}
        draws = torch.Generator().manual_seed(0)
        codes = self._encode(self.held_out)
        rows = torch.arange(len(self.held_out), device=self.device)
        losses = [self._flow_loss(codes, rows, draws) for _ in range(VALIDATION_DRAWS)]
        return {"validation_flow_loss": float(torch.stack(losses).mean())}

    @torch.no_grad()
    def mean_iou(self) -> float:
        """Mean occupancy IoU of held-out shapes with their reconstructions."""
        total = 0.0
        for start in range(0, len(self.held_out), self.batch_size):
            part = slice(start, start + self.batch_size)
            found = self.generator.descend(self.generator.encode_shapes(self.held_out[part]))
            total += float(occupancy_iou(found.inside, self.inside[part]).sum())
        return total / len(self.held_out)

    def finish_epoch(self, epoch: int, last: bool, folder: Path) -> dict[str, float]:
        """The step size after the epoch."""
        if self._flowing:
            return {"learning_rate": self.flow.rate_at(self.taken - self.first_flow_step)}
        return {"learning_rate": self.autoencoder.rate_at(self.taken)}

    def finish(self) -> None:
        """Without a flow codes are drawn as independent normals of the training codes' mean and deviation."""
        if not self._flowing:
            self._standardise()

    def parts(self) -> dict[str, Any]:
        return {
            "generator": self.generator,
            "autoencoder_optimizer": self.autoencoder.optimizer,
            "autoencoder_average": self.autoencoder.average,
            "flow_optimizer": self.flow.optimizer,
            "flow_average": self.flow.average,
        }


def _read_shapes(
    store: FieldStore, split: Split, sets: ActiveSets
) -> tuple[list[ActiveShape], Bool[np.ndarray, "N T"]]:
    """Active shapes of a split, and the occupancy of all their finest tets."""
    shapes, inside = [], []
    for shape_id in store.ids(split):
        field = store.read(shape_id)
        shapes.append(sets.shape(field.occupancy, field.displacement))
        inside.append(field.occupancy)
    tets = len(store.hierarchy.finest.tets)
    return shapes, np.array(inside, dtype=bool).reshape(-1, tets)
