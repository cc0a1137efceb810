"""A learner for models of fields with one optimiser: the least that a new model has to say is its loss."""

from abc import ABC, abstractmethod
from typing import Any

import torch
from jaxtyping import Float, Int
from torch import Tensor

from tetgan.fields.store import FieldStore
from tetgan.models.measures import occupancy_iou
from tetgan.models.options import KindOptions
from tetgan.models.registry import build_generator
from tetgan.nn.device import pick_device
from tetgan.training.checkpoint import run_digest
from tetgan.training.common import FieldTraining
from tetgan.training.data import open_fields
from tetgan.training.kind_learner import seeded
from tetgan.training.runlog import Losses


class FieldLearner(ABC):
    """Adam on a sum of terms, on batches of fields."""

    terms: tuple[str, ...]
    """Names of the terms, which are columns of the log."""

    def __init__(self, options: KindOptions, training: FieldTraining, store: FieldStore, seed: int) -> None:
        self.epochs, self.batch_size = training.epochs, training.batch_size
        self.device = pick_device(training.device)
        self.data, self.held_out = (
            open_fields(store, split, self.device, "auto") for split in ("train", "validation")
        )
        self.data_digest = run_digest(grid=store.hierarchy.digest, train=self.data.digest)
        with seeded(seed):
            self.generator = build_generator(options, store.hierarchy).to(self.device)
        self.optimizer = torch.optim.Adam(self.generator.parameters(), training.learning_rate)

    @abstractmethod
    def loss(self, field: Float[Tensor, "B T 4"], draws: torch.Generator) -> dict[str, Float[Tensor, ""]]:
        """The terms of the loss of a batch, by name; any random number comes from `draws`."""

    @property
    def losses(self) -> tuple[str, ...]:
        return (*self.terms, "validation_iou")

    @property
    def shapes(self) -> int:
        return len(self.data)

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """One step of Adam."""
        terms = self.loss(self.data.batch(rows), draws)
        self.optimizer.zero_grad()
        torch.stack(list(terms.values())).sum().backward()
        self.optimizer.step()
        return {name: term.detach() for name, term in terms.items()}

    @torch.no_grad()
    def validate(self) -> dict[str, float]:
        """Mean occupancy IoU of validation shapes and what comes back of them."""
        if not len(self.held_out):
            return {}
        total = 0.0
        for rows in torch.arange(len(self.held_out)).split(self.batch_size):
            field = self.held_out.batch(rows)
            decoded = self.generator.decode(self.generator.encode(field))
            inside, true = (decoded[..., 0] > 0).cpu().numpy(), (field[..., 0] > 0.5).cpu().numpy()
            total += float(occupancy_iou(inside, true).sum())
        return {"validation_iou": total / len(self.held_out)}

    def parts(self) -> dict[str, Any]:
        return {"generator": self.generator, "optimizer": self.optimizer}
