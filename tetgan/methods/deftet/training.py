"""Training of DefTet's surface network on boundaries of true occupancies."""

import hashlib
import math
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Literal

import torch
from jaxtyping import Float, Int
from scipy import sparse
from torch import Tensor
from torch.nn import functional

from tetgan.errors import UserError
from tetgan.fields.field import vertex_operator
from tetgan.fields.store import FieldStore
from tetgan.methods.deftet.network import DeftetGenerator, SurfaceGraph, surface_graph
from tetgan.methods.deftet.options import DeftetOptions, DeftetTraining
from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.methods.tetgan.schedule import rate_factor
from tetgan.nn.device import pick_device
from tetgan.training.average import WeightAverage
from tetgan.training.checkpoint import run_digest
from tetgan.training.learner import Learner, seeded
from tetgan.training.log import Losses

Surface = tuple[SurfaceGraph, Float[Tensor, "_n 3"]]


class DeftetLearner(Learner):
    """Adam on the surface network; the TetGAN that it moves the boundary of is only saved beside it."""

    generator: DeftetGenerator

    losses = ("learning_rate", "displacement_loss", "validation_displacement_loss")

    def __init__(
        self,
        options: DeftetOptions,
        training: DeftetTraining,
        store: FieldStore,
        seed: int,
        of: TetganGenerator,
    ) -> None:
        self.training, self.epochs, self.batch_size = training, training.epochs, training.batch_size
        operator = vertex_operator(store.hierarchy.finest)
        self.surfaces = _read_surfaces(store, "train", operator)
        self.held_out = _read_surfaces(store, "validation", operator)
        if not self.surfaces:
            raise UserError("deftet: no training shape has a surface on this grid; use a finer one")
        self.shapes = len(self.surfaces)
        self.steps = self.epochs * math.ceil(self.shapes / self.batch_size)
        self.data_digest = run_digest(grid=store.hierarchy.digest, train=_digest(self.surfaces))
        with seeded(seed):
            self.generator = DeftetGenerator(options, store.hierarchy, of)
        self.generator.to(pick_device(training.device))
        self.generator.unit.fill_(store.mu)
        self.network = self.generator.network
        self.optimizer = torch.optim.Adam(
            self.network.parameters(), training.learning_rate, betas=training.betas
        )
        self.average = WeightAverage(self.network, training.ema)

    def batches(self, order: Int[Tensor, "N"]) -> Sequence[Int[Tensor, "_B"]]:
        """Full batches, and what is left over."""
        return order.split(self.batch_size)

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """One step of Adam."""
        self.optimizer.param_groups[0]["lr"] = self._rate(step / self.steps)
        loss = self._loss([self.surfaces[row] for row in rows.tolist()])
        self.optimizer.zero_grad()
        loss.backward()
        self.optimizer.step()
        self.average.update()
        return {"displacement_loss": float(loss.detach())}

    def _rate(self, progress: float) -> float:
        return self.training.learning_rate * rate_factor(progress, self.training.decay)

    def _loss(self, surfaces: list[Surface]) -> Float[Tensor, ""]:
        """Squared error per coordinate of a vertex displacement, in units of mu."""
        moved = self.network([graph for graph, _ in surfaces])
        return functional.mse_loss(moved, torch.cat([target for _, target in surfaces]).to(moved.device))

    def averaged(self) -> AbstractContextManager[None]:
        return self.average.applied()

    @torch.no_grad()
    def validate(self) -> dict[str, float]:
        """The loss of validation shapes."""
        return {"validation_displacement_loss": float(self._loss(self.held_out))} if self.held_out else {}

    def finish_epoch(self, epoch: int, last: bool, folder: Path) -> dict[str, float]:
        return {"learning_rate": self._rate(epoch / self.epochs)}

    def parts(self) -> dict[str, Any]:
        return {"network": self.network, "optimizer": self.optimizer, "average": self.average}


def _read_surfaces(
    store: FieldStore, split: Literal["train", "validation"], operator: sparse.csr_array
) -> list[Surface]:
    """The boundary of every shape that has one, and how far Eq. 3 moves it, in units of mu."""
    surfaces = []
    for shape_id in store.ids(split):
        field = store.read(shape_id)
        graph = surface_graph(field.occupancy, store.hierarchy.finest)
        if len(graph.vertices):
            target = operator[graph.vertices] @ field.displacement / store.mu
            surfaces.append((graph, torch.from_numpy(target).float()))
    return surfaces


def _digest(surfaces: list[Surface]) -> str:
    sha = hashlib.sha256()
    for graph, target in surfaces:
        sha.update(graph.vertices.tobytes() + target.numpy().tobytes())
    return sha.hexdigest()
