"""Chamfer distance between every shape of one set and every shape of another."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Int
from rich.console import Console
from rich.progress import track
from torch import Tensor

from tetgan.nn.device import pick_device

Clouds = Float[np.ndarray, "_ _ 3"]

# Squared distances held at once: those of a core fit its cache, those of a GPU keep it busy.
_BLOCK = {"cpu": 2**18, "cuda": 2**27}


def chamfer_between(first: Clouds, second: Clouds, label: str = "pairs") -> Float[np.ndarray, "N M"]:
    """Mean squared distance to the nearest point, each way, summed, for every pair of clouds.

    The definition of `tetgan.evaluation.chamfer`, all distances of a pair at once and in single precision:
    a squared distance is off by about 1e-7 of the clouds' squared extent, and equal clouds may be that far
    from 0. For the few hundred points that sets are compared with this is quicker than a tree.

    Args:
        first: (N, P, 3) points.
        second: (M, Q, 3) points.
        label: shown beside the progress bar.
    """
    origin = second.reshape(-1, 3).mean(0)
    rows, columns = _queries(first - origin), _targets(second - origin)
    return _matrix([_chamfer(row, columns) for row in _track(rows, label, len(rows))])


def chamfer_within(clouds: Clouds, label: str = "pairs") -> Float[np.ndarray, "N N"]:
    """The same between all clouds of one set: symmetric, 0 on the diagonal."""
    centered = clouds - clouds.reshape(-1, 3).mean(0)
    columns = _targets(centered)
    upper = np.zeros((len(clouds), len(clouds)))
    for place, row in enumerate(_track(_queries(centered), label, len(clouds))):
        upper[place, place + 1 :] = _matrix([_chamfer(row, columns[place + 1 :])])[0]
    return upper + upper.T


def chamfer_selected(
    first: Clouds, second: Clouds, columns: Int[np.ndarray, "N K"], label: str = "pairs"
) -> Float[np.ndarray, "N K"]:
    """The same for some pairs alone: every cloud of the first set with its own K of the second."""
    origin = second.reshape(-1, 3).mean(0)
    rows, targets = _queries(first - origin), _targets(second - origin)
    chosen = zip(rows, torch.from_numpy(columns).to(targets.device), strict=True)
    return _matrix([_chamfer(row, targets[own]) for row, own in _track(chosen, label, len(rows))])


def resampled_chamfer(points: Float[np.ndarray, "P 3"], count: int) -> float:
    """Distance of a shape from itself, sampled twice with `count` points, or with half of those given.

    `points` stand in random order, so that two parts of them are two samples.
    """
    count = min(count, len(points) // 2)
    first, second = points[None, :count], points[None, count : 2 * count]
    origin = second.reshape(-1, 3).mean(0)
    return float(_chamfer(_queries(first - origin)[0], _targets(second - origin))[0])


def _chamfer(row: Float[Tensor, "P 5"], columns: Float[Tensor, "M Q 5"]) -> Float[Tensor, "M"]:
    """One cloud against many."""
    block = max(1, _BLOCK[row.device.type] // (len(row) * columns.shape[1]))
    found = []
    for part in columns.split(block):
        squares = (row @ part.flatten(0, 1).T).unflatten(1, part.shape[:2])
        forth, back = squares.amin(2).clamp_(min=0), squares.amin(0).clamp_(min=0)
        found.append(forth.mean(0) + back.mean(1))
    return torch.cat(found)


def _queries(points: Clouds) -> Float[Tensor, "N P 5"]:
    """(x, |x|^2, 1): times (-2 y, 1, |y|^2) that is |x - y|^2, so one product gives all distances."""
    lifted = _tensor(points)
    square = lifted.square().sum(2, keepdim=True)
    return torch.cat([lifted, square, torch.ones_like(square)], dim=2)


def _targets(points: Clouds) -> Float[Tensor, "N P 5"]:
    lifted = _tensor(points)
    square = lifted.square().sum(2, keepdim=True)
    return torch.cat([-2 * lifted, torch.ones_like(square), square], dim=2)


def _tensor(points: Clouds) -> Float[Tensor, "N P 3"]:
    return torch.from_numpy(np.ascontiguousarray(points, dtype=np.float32)).to(pick_device("auto"))


def _matrix(rows: list[Tensor]) -> Float[np.ndarray, "N M"]:
    return torch.stack(rows).double().cpu().numpy()


def _track(items: Iterable[Any], label: str, total: int) -> Iterable[Any]:
    return track(items, label, total, console=Console(stderr=True), transient=True)
