"""What the metrics cost, beside the plain way of computing them."""

from collections.abc import Callable
from time import perf_counter, process_time
from typing import Annotated, Any

import numpy as np
import torch
import typer
from torch.nn import functional

from tetgan.evaluation.chamfer import SurfaceSample, chamfer
from tetgan.evaluation.features import cloud_features
from tetgan.evaluation.frechet import fid, fid_interval, kid_interval
from tetgan.evaluation.options import VarietyOptions
from tetgan.evaluation.variety import variety
from tetgan.models.pointnet2 import PointNet2, group_points, prepare_clouds


def main(
    shapes: Annotated[int, typer.Option(help="shapes on each side")] = 256,
    points: Annotated[int, typer.Option(help="points a surface for Chamfer and variety")] = 10_000,
    threads: Annotated[int, typer.Option(help="threads of torch and of KD-trees")] = 2,
) -> None:
    """Wall and CPU seconds on points of random ellipsoids."""
    torch.set_num_threads(threads)
    rng = np.random.default_rng(0)
    samples = [_ellipsoid(rng, points) for _ in range(shapes)]
    seconds = _timed("Chamfer, a pair", lambda: chamfer(samples[0], samples[1]))
    options = VarietyOptions()
    shortcut = _timed("variety", lambda: variety(samples, options, np.random.default_rng(0), threads))
    plain = options.pairs * options.repeats * seconds / threads
    typer.echo(f"  every pair in full would take {plain / shortcut:.1f} times as long")
    clouds = np.stack([sample.points[:2048] for sample in samples]).astype(np.float32)
    network = PointNet2(6).eval()
    _timed(f"features of {shapes} clouds", lambda: cloud_features(clouds, network))
    _time_training(clouds[:24])
    first, second = rng.normal(size=(2, shapes, 256))
    _timed("FID", lambda: fid(first, second))
    _timed("FID, 100 resamples", lambda: fid_interval(first, second, 100, 0.95, rng))
    _timed("KID, 1,000 resamples", lambda: kid_interval(first, second, 1000, 0.95, rng))


def _time_training(clouds: np.ndarray) -> None:
    network, labels = PointNet2(6), torch.arange(len(clouds)) % 6
    points = prepare_clouds(torch.from_numpy(clouds))
    groupings = group_points(points)

    def step() -> None:
        network.zero_grad()
        functional.cross_entropy(network(points, groupings), labels).backward()

    _timed(f"balls of {len(clouds)} clouds", lambda: group_points(points))
    step()
    _timed(f"training step of {len(clouds)} clouds", step)


def _ellipsoid(rng: np.random.Generator, points: int) -> SurfaceSample:
    normals = rng.normal(size=(points, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sample = SurfaceSample(0.5 + normals * rng.uniform(0.1, 0.5, 3), normals)
    _ = sample.tree
    return sample


def _timed(label: str, work: Callable[[], Any]) -> float:
    wall, cpu = perf_counter(), process_time()
    work()
    wall, cpu = perf_counter() - wall, process_time() - cpu
    typer.echo(f"{label:32s} {wall:8.3f} s wall, {cpu:8.3f} s CPU")
    return wall


if __name__ == "__main__":
    typer.run(main)
