"""Training of the PointNet++ classifier on clouds of every category."""

import hashlib
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import torch
from jaxtyping import Float, Int
from rich.console import Console
from rich.progress import track
from torch import Tensor, nn
from torch.nn import functional

from tetgan.errors import UserError
from tetgan.extractor.network import (
    INPUT_POINTS,
    Grouping,
    PointNet2,
    group_points,
    load_classifier,
    prepare_clouds,
    save_classifier,
)
from tetgan.extractor.options import ExtractorOptions
from tetgan.files import whole_folder
from tetgan.shapes.clouds import read_clouds
from tetgan.training.checkpoint import run_digest
from tetgan.training.learner import Learner, seeded
from tetgan.training.log import Losses
from tetgan.training.loop import TrainingLoop

CHUNK = 8
"""Clouds prepared or classified at once outside training; more only takes memory."""


class LabelledClouds(NamedTuple):
    """Prepared clouds, their balls (16-bit, they number 1,024 at most), and the class of each."""

    points: Float[Tensor, "N 1024 3"]
    groupings: tuple[Grouping, ...]
    labels: Int[Tensor, "N"]

    def pick(self, rows: Int[Tensor, "B"]) -> "LabelledClouds":
        """Some of the clouds, their balls as the network takes them."""
        groupings = tuple(
            Grouping(level.centers[rows].long(), level.members[rows].long()) for level in self.groupings
        )
        return LabelledClouds(self.points[rows], groupings, self.labels[rows])

    @property
    def digest(self) -> str:
        """SHA-256 of points and labels."""
        sha = hashlib.sha256()
        for tensor in (self.points, self.labels):
            sha.update(np.ascontiguousarray(tensor.cpu().numpy()).data)
        return sha.hexdigest()


def read_splits(
    clouds: Sequence[Path], options: ExtractorOptions, device: torch.device
) -> tuple[LabelledClouds, LabelledClouds]:
    """Training and hold-out clouds of all categories, prepared once: the balls survive every epoch.

    Raises:
        UserError: a file has too few points a cloud, or no clouds.
    """
    chosen: dict[str, list[np.ndarray]] = {"train": [], "holdout": []}
    for path in clouds:
        found = read_clouds(path)
        chosen["train"].append(_choose(found.train, options.train, options.seed, path))
        chosen["holdout"].append(_choose(found.holdout, options.holdout, options.seed, path))
    train, holdout = (_prepare(parts, device, split) for split, parts in chosen.items())
    return train, holdout


def _choose(
    array: Float[np.ndarray, "N P 3"], most: int, seed: int, path: Path
) -> Float[np.ndarray, "M P 3"]:
    if not len(array):
        raise UserError(f"{path}: no clouds to train or test a classifier on")
    if array.shape[1] < INPUT_POINTS:
        raise UserError(f"{path}: {array.shape[1]} points a cloud; the classifier needs {INPUT_POINTS}")
    order = np.random.default_rng(seed).permutation(len(array))
    return array[np.sort(order[:most])]


def _prepare(parts: Sequence[Float[np.ndarray, "_ P 3"]], device: torch.device, split: str) -> LabelledClouds:
    labels = torch.cat([torch.full((len(part),), label) for label, part in enumerate(parts)])
    chunks = [chunk for part in parts for chunk in torch.from_numpy(part).split(CHUNK)]
    points, groupings = [], []
    for chunk in track(chunks, f"{split} clouds", console=Console(stderr=True), transient=True):
        points.append(prepare_clouds(chunk.to(device)))
        groupings.append([Grouping(*(part.short() for part in level)) for level in group_points(points[-1])])
    levels = tuple(
        Grouping(*map(torch.cat, zip(*level, strict=True))) for level in zip(*groupings, strict=True)
    )
    return LabelledClouds(torch.cat(points), levels, labels.to(device))


def train_classifier(
    clouds: Sequence[Path], categories: Sequence[str], options: ExtractorOptions, out_folder: Path
) -> None:
    """Train on the training clouds, log the accuracy on hold-out clouds; a seed gives the same weights again.

    Args:
        clouds: one file of clouds a category (`tetgan.shapes.clouds`).
        categories: their names, in the same order.
        out_folder: receives `weights.safetensors`, `options.json` and `log.csv` (epoch, seconds, loss,
            train_accuracy, holdout_accuracy), and unless a checkpoint is taken `events/` and `checkpoint.pt`,
            from which a killed run goes on.

    Raises:
        UserError: fewer than two categories, clouds too small, a checkpoint of other categories, or a
            training that diverges in its first epoch.
    """
    if len(categories) < 2:
        raise UserError("extractor: a classifier needs at least two categories; add sources")
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    train, holdout = read_splits(clouds, options, device)
    if options.checkpoint is None:
        _train(ClassifierLearner(train, holdout, len(categories), options), categories, out_folder)
        return
    with whole_folder(out_folder, "log.csv") as folder:
        _take_checkpoint(options.checkpoint, categories, holdout, folder)


def _train(
    learner: "ClassifierLearner",
    categories: Sequence[str],
    folder: Path,
    checkpoint_seconds: float = 120.0,
) -> None:
    settings = learner.options.model_dump(mode="json")
    loop = TrainingLoop(
        learner,
        folder,
        learner.options.seed,
        options={"training": settings, "categories": list(categories)},
        checkpoint_seconds=checkpoint_seconds,
    )

    def save(**about: Any) -> None:
        about |= {"categories": list(categories), "options": settings, **learner.validate()}
        save_classifier(folder, learner.network, about)

    loop.run(save)


class ClassifierLearner(Learner):
    """Adam on the cross-entropy of the classes."""

    losses = ("loss", "train_accuracy", "holdout_accuracy")

    def __init__(
        self, train: LabelledClouds, holdout: LabelledClouds, classes: int, options: ExtractorOptions
    ) -> None:
        self.train, self.holdout, self.options = train, holdout, options
        self.shapes, self.epochs, self.batch_size = len(train.labels), options.epochs, options.batch_size
        self.data_digest = run_digest(train=train.digest, holdout=holdout.digest)
        with seeded(options.seed):
            self.generator = self.network = PointNet2(classes).to(train.points.device)
        self.norms = [module for module in self.network.modules() if isinstance(module, nn.BatchNorm1d)]
        self.optimizer = torch.optim.Adam(self.network.parameters(), weight_decay=options.weight_decay)

    def batches(self, order: Int[Tensor, "N"]) -> Sequence[Int[Tensor, "_B"]]:
        """Full batches, and what is left over, unless that is one cloud: batch norm needs two."""
        return [rows for rows in order.split(self.batch_size) if len(rows) > 1]

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """One step of Adam."""
        options = self.options
        rate = options.learning_rate * options.decay ** (int(epoch) // options.decay_every)
        self.optimizer.param_groups[0]["lr"] = rate
        batch = self.train.pick(rows.to(self.train.labels.device))
        points = _turn(batch.points, draws) if options.rotate else batch.points
        self.network.train()
        for norm in self.norms:
            norm.momentum = _momentum(norm)
        with _drawing_from(draws, points.device):  # which of the features are dropped
            scores = self.network(points, batch.groupings)
        loss = functional.cross_entropy(scores, batch.labels)
        self.optimizer.zero_grad()
        loss.backward()
        self.optimizer.step()
        right = (scores.detach().argmax(1) == batch.labels).float().mean()
        return {"loss": loss.detach(), "train_accuracy": right}

    def validate(self) -> dict[str, float]:
        return {"holdout_accuracy": accuracy(self.network, self.holdout)}

    def parts(self) -> dict[str, Any]:
        return {"network": self.network, "optimizer": self.optimizer}


@torch.no_grad()
def accuracy(network: PointNet2, clouds: LabelledClouds) -> float:
    """Share of the clouds whose class has the highest score."""
    network.eval()
    right = 0
    for rows in torch.arange(len(clouds.labels), device=clouds.labels.device).split(CHUNK):
        batch = clouds.pick(rows)
        right += int((network(batch.points, batch.groupings).argmax(1) == batch.labels).sum())
    return right / len(clouds.labels)


@contextmanager
def _drawing_from(draws: torch.Generator, device: torch.device) -> Iterator[None]:
    """Inside, PyTorch's own generators give what follows from `draws`, outside what they would have."""
    with torch.random.fork_rng(devices=[device] if device.type == "cuda" else []):
        torch.manual_seed(int(torch.randint(2**62, (1,), generator=draws)))
        yield


def _momentum(norm: nn.BatchNorm1d) -> float:
    """Weight of the next batch in the running statistics: plain averages first, torch's 0.1 from then on.

    They start at variance 1, far above that of coordinates within a ball; at 0.1 from the start, that one
    value outweighs the data for the first hundred steps, and the network is blind outside training.
    """
    assert norm.num_batches_tracked is not None
    return max(0.1, 1 / (int(norm.num_batches_tracked) + 1))


def _turn(points: Float[Tensor, "B P 3"], generator: torch.Generator) -> Float[Tensor, "B P 3"]:
    """Each cloud turned about the vertical axis (y) by its own angle."""
    angle = (2 * torch.pi * torch.rand(len(points), 1, generator=generator)).to(points.device)
    x, y, z = points.unbind(2)
    cos, sin = angle.cos(), angle.sin()
    return torch.stack([cos * x + sin * z, y, cos * z - sin * x], dim=2)


def _take_checkpoint(source: Path, categories: Sequence[str], holdout: LabelledClouds, folder: Path) -> None:
    """Copy a trained classifier and say how accurate it is here."""
    classifier = load_classifier(source, holdout.points.device)
    missing = sorted(set(categories) - set(classifier.categories))
    if missing:
        raise UserError(f"extractor.checkpoint: {source} does not know {', '.join(missing)}")
    place = torch.tensor(
        [classifier.categories.index(name) for name in categories], device=holdout.labels.device
    )
    measured = accuracy(classifier.network, holdout._replace(labels=place[holdout.labels]))
    about = {
        "categories": list(classifier.categories),
        "holdout_accuracy": measured,
        "checkpoint": classifier.digest,
    }
    save_classifier(folder, classifier.network, about)
    shutil.copyfile(Path(source) / "weights.safetensors", folder / "weights.safetensors")  # the same digest
    row = {"epoch": 0, "seconds": None, "loss": None, "train_accuracy": None, "holdout_accuracy": measured}
    pd.DataFrame([row]).to_csv(folder / "log.csv", index=False)
