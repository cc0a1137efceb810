"""Stage: train the PointNet++ classifier on clouds of every category."""

import logging
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import torch
from jaxtyping import Float, Int
from rich.console import Console
from rich.progress import track
from torch import Tensor, nn
from torch.nn import functional

from tetgan.errors import UserError
from tetgan.files import whole_folder
from tetgan.models.pointnet2 import (
    INPUT_POINTS,
    Grouping,
    PointNet2,
    group_points,
    load_classifier,
    prepare_clouds,
    save_classifier,
)
from tetgan.shapes.clouds import read_clouds
from tetgan.training.extractor_options import ExtractorOptions

_log = logging.getLogger(__name__)

# Clouds prepared or classified at once outside training; more only takes memory.
_CHUNK = 8


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


def train_classifier(
    clouds: Sequence[Path], categories: Sequence[str], options: ExtractorOptions, out_folder: Path
) -> None:
    """Train on the training clouds, log the accuracy on hold-out clouds; a seed gives the same weights again.

    Args:
        clouds: one file of clouds a category (`tetgan.shapes.clouds`).
        categories: their names, in the same order.
        out_folder: receives `weights.safetensors`, `options.json` and `log.csv` (epoch, loss, train_accuracy,
            holdout_accuracy).

    Raises:
        UserError: fewer than two categories, clouds too small, or a checkpoint of other categories.
    """
    if len(categories) < 2:
        raise UserError("extractor: a classifier needs at least two categories; add sources")
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    train, holdout = read_splits(clouds, options, device)
    with whole_folder(out_folder) as folder:
        if options.checkpoint is not None:
            _take_checkpoint(options.checkpoint, categories, holdout, folder)
            return
        network, rows = _fit(train, holdout, len(categories), options)
        pd.DataFrame(rows).to_csv(folder / "log.csv", index=False)
        about = {
            "categories": list(categories),
            "holdout_accuracy": rows[-1]["holdout_accuracy"],
            "options": options.model_dump(mode="json"),
        }
        save_classifier(folder, network, about)


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


@torch.no_grad()
def accuracy(network: PointNet2, clouds: LabelledClouds) -> float:
    """Share of the clouds whose class has the highest score."""
    network.eval()
    right = 0
    for rows in torch.arange(len(clouds.labels), device=clouds.labels.device).split(_CHUNK):
        batch = clouds.pick(rows)
        right += int((network(batch.points, batch.groupings).argmax(1) == batch.labels).sum())
    return right / len(clouds.labels)


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
    chunks = [chunk for part in parts for chunk in torch.from_numpy(part).split(_CHUNK)]
    points, groupings = [], []
    for chunk in track(chunks, f"{split} clouds", console=Console(stderr=True), transient=True):
        points.append(prepare_clouds(chunk.to(device)))
        groupings.append([Grouping(*(part.short() for part in level)) for level in group_points(points[-1])])
    levels = tuple(
        Grouping(*map(torch.cat, zip(*level, strict=True))) for level in zip(*groupings, strict=True)
    )
    return LabelledClouds(torch.cat(points), levels, labels.to(device))


def _fit(
    train: LabelledClouds, holdout: LabelledClouds, classes: int, options: ExtractorOptions
) -> tuple[PointNet2, list[dict[str, float | int]]]:
    """The trained network and a row of the log an epoch."""
    device = train.points.device
    with torch.random.fork_rng(devices=[device] if device.type == "cuda" else []):
        torch.manual_seed(options.seed)  # initial weights and dropout
        generator = torch.Generator().manual_seed(options.seed)  # order and rotation
        network = PointNet2(classes).to(device)
        optimizer = torch.optim.Adam(
            network.parameters(), lr=options.learning_rate, weight_decay=options.weight_decay
        )
        schedule = torch.optim.lr_scheduler.StepLR(optimizer, options.decay_every, options.decay)
        rows = []
        for epoch in track(
            range(1, options.epochs + 1), "classifier", console=Console(stderr=True), transient=True
        ):
            loss, train_accuracy = _train_epoch(network, optimizer, train, options, generator)
            schedule.step()
            held_out = accuracy(network, holdout)
            _log.info(
                "epoch %d: loss %.4f, accuracy %.3f, held out %.3f", epoch, loss, train_accuracy, held_out
            )
            rows.append(
                {"epoch": epoch, "loss": loss, "train_accuracy": train_accuracy, "holdout_accuracy": held_out}
            )
    return network, rows


def _train_epoch(
    network: PointNet2,
    optimizer: torch.optim.Optimizer,
    clouds: LabelledClouds,
    options: ExtractorOptions,
    generator: torch.Generator,
) -> tuple[float, float]:
    """Mean loss and share of right answers, as training saw them."""
    network.train()
    norms = [module for module in network.modules() if isinstance(module, nn.BatchNorm1d)]
    loss_sum, right, seen = 0.0, 0, 0
    for rows in _batches(len(clouds.labels), options.batch_size, generator):
        batch = clouds.pick(rows.to(clouds.labels.device))
        for norm in norms:
            norm.momentum = _momentum(norm)
        points = _turn(batch.points, generator) if options.rotate else batch.points
        scores = network(points, batch.groupings)
        loss = functional.cross_entropy(scores, batch.labels)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        loss_sum += loss.item() * len(rows)
        right += int((scores.argmax(1) == batch.labels).sum())
        seen += len(rows)
    return loss_sum / seen, right / seen


def _momentum(norm: nn.BatchNorm1d) -> float:
    """Weight of the next batch in the running statistics: plain averages first, torch's 0.1 from then on.

    They start at variance 1, far above that of coordinates within a ball; at 0.1 from the start, that one
    value outweighs the data for the first hundred steps, and the network is blind outside training.
    """
    assert norm.num_batches_tracked is not None
    return max(0.1, 1 / (int(norm.num_batches_tracked) + 1))


def _batches(size: int, batch_size: int, generator: torch.Generator) -> Iterator[Int[Tensor, "B"]]:
    """A random order in batches; a last batch of one is left out, for batch norm needs two."""
    batches = torch.randperm(size, generator=generator).split(batch_size)
    return (batch for batch in batches if len(batch) > 1)


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
    row = {"epoch": 0, "loss": None, "train_accuracy": None, "holdout_accuracy": measured}
    pd.DataFrame([row]).to_csv(folder / "log.csv", index=False)
