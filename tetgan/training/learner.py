"""The contract of learners, and one for models of fields with one optimiser."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from tetgan.fields.store import FieldStore
from tetgan.models.files import build_generator
from tetgan.models.generator import FieldGenerator
from tetgan.models.iou import occupancy_iou
from tetgan.models.method import MethodOptions
from tetgan.nn.device import pick_device
from tetgan.training.checkpoint import run_digest
from tetgan.training.data import open_fields
from tetgan.training.log import Losses
from tetgan.training.options import FieldTraining


class Learner(ABC):
    """Networks, optimisers and data of one run: all that the training loop leaves to a method."""

    generator: nn.Module
    """The model, whose weights are saved."""

    losses: tuple[str, ...]
    """Names of everything that `take_step`, `validate` and `finish_epoch` return: the columns of the log."""

    data_digest: str
    """Digest of all that it learns from."""

    shapes: int
    """Number of training shapes."""

    epochs: int
    """Passes over them."""

    batch_size: int
    """Most shapes of a step."""

    @abstractmethod
    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """Train on some of the training shapes; all random numbers come from `draws`.

        Args:
            rows: their places.
            step: steps before this one.
            epoch: epochs before this step, the one under way by its share.
        """

    @abstractmethod
    def parts(self) -> dict[str, Any]:
        """Objects with a state, by name: with `draws`, all that the next step depends on."""

    def validate(self) -> dict[str, float]:
        """Measures of validation shapes; empty where there are none, or no encoder."""
        return {}

    def batches(self, order: Int[Tensor, "N"]) -> Sequence[Int[Tensor, "_B"]]:
        """The steps of an epoch, whose shapes come in some order; parts as equal as can be by default."""
        return order.tensor_split(math.ceil(len(order) / self.batch_size))

    def start(self, step: int, rows: Callable[[int], Int[Tensor, "_B"]]) -> None:
        """Called once before the first step of this process, to read ahead of use.

        Args:
            step: steps before that one, 0 unless a run is resumed.
            rows: the shapes of a step.
        """
        return None

    def averaged(self) -> AbstractContextManager[None]:
        """Inside, the generator has the weights that are validated and saved: by default its own."""
        return nullcontext()

    def finish_epoch(self, epoch: int, last: bool, folder: Path) -> dict[str, float]:
        """Called after each epoch, by every process: further numbers for the log, pictures for the folder."""
        return {}

    def finish(self) -> None:
        """Called before the model is saved; the generator has the weights that are kept."""
        return None


@contextmanager
def seeded(seed: int) -> Iterator[None]:
    """Inside, PyTorch's global generator, which weights are drawn from, starts from the seed."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        yield


class FieldLearner(Learner):
    """Adam on a sum of terms, on batches of fields."""

    generator: FieldGenerator

    terms: tuple[str, ...]
    """Names of the terms, which are columns of the log."""

    def __init__(
        self,
        options: MethodOptions,
        training: FieldTraining,
        store: FieldStore,
        seed: int,
        of: FieldGenerator | None = None,
    ) -> None:
        """`of` is the trained model that this one is built on, if any; its weights do not change."""
        self.losses = (*self.terms, "validation_iou")
        self.epochs, self.batch_size = training.epochs, training.batch_size
        self.device = pick_device(training.device)
        self.data, self.held_out = (
            open_fields(store, split, self.device, "auto") for split in ("train", "validation")
        )
        self.shapes = len(self.data)
        self.data_digest = run_digest(grid=store.hierarchy.digest, train=self.data.digest)
        with seeded(seed):
            self.generator = build_generator(options, store.hierarchy, of).to(self.device)
        learned = [weight for weight in self.generator.parameters() if weight.requires_grad]
        self.optimizer = torch.optim.Adam(learned, training.learning_rate)

    @abstractmethod
    def loss(self, field: Float[Tensor, "B T 4"], draws: torch.Generator) -> dict[str, Float[Tensor, ""]]:
        """The terms of the loss of a batch, by name; any random number comes from `draws`."""

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
