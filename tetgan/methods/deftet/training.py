"""Training of DefTet's surface network on boundaries of true occupancies."""

import hashlib
import math
from pathlib import Path
from typing import Any, Literal

import torch
from jaxtyping import Float
from scipy import sparse
from torch import Tensor
from torch.nn import functional

from tetgan.errors import UserError
from tetgan.fields.field import vertex_operator
from tetgan.fields.store import FieldStore
from tetgan.methods.deftet.network import DeftetGenerator, SurfaceGraph, surface_graph
from tetgan.methods.deftet.options import DeftetOptions
from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.methods.tetgan.schedule import rate_factor
from tetgan.models.files import load_generator, load_options, save_generator
from tetgan.nn.device import pick_device
from tetgan.training.average import WeightAverage
from tetgan.training.checkpoint import run_digest
from tetgan.training.data import open_training
from tetgan.training.log import Losses
from tetgan.training.loop import WITHOUT_EFFECT, TrainingLoop, step_draws

Surface = tuple[SurfaceGraph, Float[Tensor, "_n 3"]]


def train_deftet(
    index: Path, options: DeftetOptions, training: TetganTraining, seed: int, folder: Path, *, of: Path
) -> None:
    """Train the network that moves the boundary of the TetGAN in the folder `of`.

    Raises:
        UserError: no training shapes, the training diverges, or `of` holds no TetGAN of this grid.
    """
    DeftetTrainer(open_training(index), options, training, seed=seed, of=of, folder=folder).run()


class DeftetTrainer(TrainingLoop):
    """A run of the surface network; the TetGAN that it moves the boundary of is only saved beside it.

    Of the training options it heeds epochs, batch size, step size and its decay, betas and averaging.
    """

    columns = ("epoch", "seconds", "learning_rate", "displacement_loss", "validation_displacement_loss")

    def __init__(
        self,
        store: FieldStore,
        options: DeftetOptions,
        training: TetganTraining,
        *,
        seed: int,
        of: Path,
        folder: Path,
    ) -> None:
        self.store, self.options, self.training = store, options, training
        operator = vertex_operator(store.hierarchy.finest)
        self.surfaces = _read_surfaces(store, "train", operator)
        self.held_out = _read_surfaces(store, "validation", operator)
        if not self.surfaces:
            raise UserError(f"{folder}: no training shape has a surface on this grid; use a finer one")
        self._build(of, seed)
        digests = {
            "options": run_digest(
                model=options.model_dump(exclude={"training"}),
                training=training.model_dump(exclude=WITHOUT_EFFECT),
                seed=seed,
            ),
            "data": run_digest(grid=store.hierarchy.digest, train=_digest(self.surfaces)),
        }
        super().__init__(
            folder,
            seed,
            epochs=training.epochs,
            steps_per_epoch=math.ceil(len(self.surfaces) / training.batch_size),
            checkpoint_seconds=training.checkpoint_seconds,
            digests=digests,
        )

    def _build(self, of: Path, seed: int) -> None:
        """The network, from the seed, and its optimiser."""
        self.of_options, moved = _load_tetgan(of, self.store)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.generator = DeftetGenerator(self.options, self.store.hierarchy, moved)
        self.generator.to(pick_device(self.training.device))
        self.generator.unit.fill_(self.store.mu)
        self.network = self.generator.network
        self.optimizer = torch.optim.Adam(
            self.network.parameters(), self.training.learning_rate, betas=self.training.betas
        )
        self.average = WeightAverage(self.network, self.training.ema)

    def take_step(self, draws: torch.Generator) -> Losses:
        """One Adam step on a batch; each epoch has an order of its own."""
        self.optimizer.param_groups[0]["lr"] = self._rate()
        epoch, place = divmod(self.step, self.steps_per_epoch)
        order = torch.randperm(len(self.surfaces), generator=step_draws(self.seed, self.steps + epoch))
        size = self.training.batch_size
        loss = self._loss([self.surfaces[row] for row in order[place * size : (place + 1) * size].tolist()])
        self.optimizer.zero_grad()
        loss.backward()
        self.optimizer.step()
        self.average.update()
        return {"displacement_loss": float(loss.detach())}

    def _rate(self) -> float:
        return self.training.learning_rate * rate_factor(self.step / self.steps, self.training)

    def _loss(self, surfaces: list[Surface]) -> Float[Tensor, ""]:
        """Squared error per coordinate of a vertex displacement, in units of mu."""
        moved = self.network([graph for graph, _ in surfaces])
        return functional.mse_loss(moved, torch.cat([target for _, target in surfaces]).to(moved.device))

    @torch.no_grad()
    def finish_epoch(self, epoch: int) -> None:
        """Validate where that is due.

        Raises:
            UserError: the training diverges.
        """
        further: dict[str, float | int] = {"seconds": self.elapsed(), "learning_rate": self._rate()}
        due = self.step == self.steps or epoch % self.training.validate_every == 0
        if self.held_out and due:
            with self.average.applied():
                further["validation_displacement_loss"] = float(self._loss(self.held_out))
        row = self.log.finish_epoch(epoch, further)
        if not math.isfinite(row["displacement_loss"]):
            raise UserError(f"{self.folder}: training diverged in epoch {epoch}; lower learning_rate")

    def parts(self) -> dict[str, Any]:
        return {"network": self.network, "optimizer": self.optimizer, "average": self.average}

    def save(self) -> None:
        """The averaged weights, and those of the TetGAN."""
        with self.average.applied():
            save_generator(
                self.folder,
                self.generator,
                self.options,
                self.store.hierarchy,
                of=self.of_options.model_dump(mode="json"),
                training=self.training.model_dump(mode="json"),
                seed=self.seed,
                minutes=round(self.elapsed() / 60, 2),
            )


def _load_tetgan(folder: Path, store: FieldStore) -> tuple[TetganOptions, TetganGenerator]:
    options, generator = load_options(folder), load_generator(folder, store.hierarchy)
    if not isinstance(options, TetganOptions) or not isinstance(generator, TetganGenerator):
        raise UserError(f"{folder}: not a TetGAN; a 'deftet' moves the boundary of one")
    return options, generator


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
