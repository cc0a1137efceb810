"""Clouds of several categories, prepared for a classifier."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from rich.console import Console
from rich.progress import track
from torch import Tensor

from tetgan.errors import UserError
from tetgan.models.pointnet2 import INPUT_POINTS, Grouping, group_points, prepare_clouds
from tetgan.shapes.clouds import read_clouds
from tetgan.training.extractor_options import ExtractorOptions

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
