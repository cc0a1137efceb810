"""The contract of learners, and one for models of fields with one optimiser."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Protocol, runtime_checkable

import torch
from jaxtyping import Float, Int
from torch import Tensor

from tetgan.fields.store import FieldStore
from tetgan.models.files import build_generator
from tetgan.models.generator import LatentModel
from tetgan.models.iou import occupancy_iou
from tetgan.models.method import MethodOptions
from tetgan.nn.device import pick_device
from tetgan.training.checkpoint import run_digest
from tetgan.training.data import open_fields
from tetgan.training.log import Losses
from tetgan.training.options import FieldTraining


@runtime_checkable
class Learner(Protocol):
    """Networks, optimisers and data of one run."""

    @property
    def generator(self) -> LatentModel:
        """The model."""

    @property
    def losses(self) -> tuple[str, ...]:
        """Names of everything that `take_step` and `validate` return: the columns of the log."""

    @property
    def data_digest(self) -> str:
        """Digest of all that it learns from."""

    @property
    def shapes(self) -> int:
        """Number of training shapes."""

    @property
    def epochs(self) -> int:
        """Passes over them."""

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """Train on some of the training shapes; all random numbers come from `draws`.

        Args:
            rows: their places.
            step: steps before this one.
            epoch: epochs before this step, the one under way by its share.
        """

    def validate(self) -> dict[str, float]:
        """Measures of reconstructed validation shapes; empty where there is none, or no encoder."""

    def parts(self) -> dict[str, Any]:
        """Objects whose state a checkpoint must hold, by name."""


@contextmanager
def seeded(seed: int) -> Iterator[None]:
    """Inside, PyTorch's global generator, which weights are drawn from, starts from the seed."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        yield


class FieldLearner(ABC):
    """Adam on a sum of terms, on batches of fields."""

    terms: tuple[str, ...]
    """Names of the terms, which are columns of the log."""

    def __init__(self, options: MethodOptions, training: FieldTraining, store: FieldStore, seed: int) -> None:
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
