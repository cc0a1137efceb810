"""What the common loop asks of every model in training, TetGAN and DefTet apart."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Protocol, runtime_checkable

import torch
from jaxtyping import Int
from torch import Tensor

from tetgan.models.generator import LatentModel
from tetgan.training.runlog import Losses


@runtime_checkable
class KindLearner(Protocol):
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
        """How well validation shapes come back; nothing where there is none, or no encoder."""

    def parts(self) -> dict[str, Any]:
        """What a checkpoint must hold."""


@contextmanager
def seeded(seed: int) -> Iterator[None]:
    """Inside, PyTorch's global generator, which weights are drawn from, starts from the seed."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        yield
