"""Time of the metrics, beside the plain way of computing them."""

from collections.abc import Callable
from time import perf_counter, process_time
from typing import Annotated, Any

import numpy as np
import torch
import typer
from records import Records, record, wall_seconds
from torch.nn import functional

from tetgan.evaluation.chamfer import SurfaceSample, chamfer
from tetgan.evaluation.fid import fid, fid_interval, kid_interval
from tetgan.evaluation.options import VarietyOptions
from tetgan.evaluation.variety import variety
from tetgan.extractor.features import cloud_features
from tetgan.extractor.network import PointNet2, group_points, prepare_clouds
from tetgan.nn.device import keep_freed_memory
from tetgan.progress import map_threads

_PAIRS, _CLOUDS, _POINTS = 250, 1000, 10_000
_CLOUD_POINTS = 2048
_QUICKER = 25


def run(quick: bool) -> Records:
    """Chamfer and features of up to 500 shapes (quick: 20), scaled to 250 pairs and 1,000 clouds."""
    keep_freed_memory()  # as the commands do
    threads = torch.get_num_threads()
    rng = np.random.default_rng(0)
    samples = [_ellipsoid(rng, _POINTS) for _ in range(2 * _PAIRS // (_QUICKER if quick else 1))]
    clouds = np.stack([sample.points[:_CLOUD_POINTS] for sample in samples]).astype(np.float32)
    network = PointNet2(6).eval()
    found: Records = {}
    for part in (4, 2, 1):
        shapes = len(samples) // part // 2 * 2
        seconds = _chamfer_seconds(samples[:shapes], threads)
        found[f"Chamfer of disjoint pairs [shapes={shapes}]"] = record(seconds, "s")
        features, _ = wall_seconds(lambda shapes=shapes: cloud_features(clouds[:shapes], network))
        found[f"features [shapes={shapes}]"] = record(features, "s")
    # The last round had all shapes; features take a time in proportion.
    pairs, factor = len(samples) // 2, _CLOUDS / len(samples)
    found[f"Chamfer, {_PAIRS} pairs of {_POINTS:,} points"] = record(seconds * _PAIRS / pairs, "s", 60)
    found[f"features, {_CLOUDS:,} clouds"] = record(features * factor, "s", 60)
    return found


def main(
    shapes: Annotated[int, typer.Option(help="shapes on each side")] = 256,
    points: Annotated[int, typer.Option(help="points a surface for Chamfer and variety")] = 10_000,
    threads: Annotated[int, typer.Option(help="threads of torch and of KD-trees")] = 2,
) -> None:
    """Wall and CPU seconds on points of random ellipsoids."""
    keep_freed_memory()
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


def _chamfer_seconds(samples: list[SurfaceSample], threads: int) -> float:
    """Of disjoint pairs, their trees included: fresh samples have none yet."""
    fresh = [SurfaceSample(sample.points, sample.normals) for sample in samples]
    chosen = np.arange(len(samples)).reshape(-1, 2)

    def distance(pair: np.ndarray) -> float:
        return chamfer(fresh[pair[0]], fresh[pair[1]])

    return wall_seconds(lambda: map_threads(distance, chosen, threads, "pairs"))[0]


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
    return SurfaceSample(0.5 + normals * rng.uniform(0.1, 0.5, 3), normals)


def _timed(label: str, work: Callable[[], Any]) -> float:
    wall, cpu = perf_counter(), process_time()
    work()
    wall, cpu = perf_counter() - wall, process_time() - cpu
    typer.echo(f"{label:32s} {wall:8.3f} s wall, {cpu:8.3f} s CPU")
    return wall


if __name__ == "__main__":
    typer.run(main)
