"""Share of time that training waits for fields on disk.

python benchmarks/streaming.py --cells 2 --depth 3 --batch 30 --width 64     the paper's LR

Fields of balls are written to a store and trained on as `fields: streamed` does: a thread reads ahead. The
share of waiting is what the loop spends in asking for the next batch, the device's own work finished before.
A reader that needs less time for a batch than a step takes is always ahead.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Annotated, NamedTuple

import numpy as np
import torch
import typer
from records import Records, record

from tetgan.fields.field import Field, vertex_operator
from tetgan.fields.store import FieldStore, index_fields, write_shard
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.grids.options import GridOptions
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.training.data import StreamedFields
from tetgan.training.loop import step_draws


class Found(NamedTuple):
    """Seconds to read a batch, seconds of an autoencoder step with it, and the share of waiting."""

    reading: float
    step: float
    waiting: float


def run(quick: bool) -> Records:
    """Reading at the paper's sizes; waiting of small networks on a CPU, of the paper's on a GPU."""
    found: Records = {}
    on_gpu = torch.cuda.is_available()
    for name, cells in (("LR", 2),) if quick else (("LR", 2), ("HR", 3)):
        with TemporaryDirectory() as folder:
            depth, batch = (1, 2) if quick else (3, 30)
            store = write_balls(Path(folder), cells, depth, shapes=2 * batch)
            found[f"reading a batch of {batch}, {name}"] = record(read_seconds(store, batch), "s")
    depth, batch, width = (3, 30, 64) if on_gpu and not quick else (2, 4, 16)
    with TemporaryDirectory() as folder:
        store = write_balls(Path(folder), 2, depth, shapes=8 * batch)
        share = train(store, batch, width, "cuda" if on_gpu else "cpu").waiting
    device = torch.cuda.get_device_name() if on_gpu else None
    found["waiting for streamed fields"] = record(share, "share of time", 0.02, "lower", device)
    return found


def write_balls(folder: Path, cells: int, depth: int, shapes: int) -> FieldStore:
    """A store of fields of random balls."""
    hierarchy = build_hierarchy(cells, depth)
    ids = [f"ball-{number:04}" for number in range(shapes)]
    rng = np.random.default_rng(0)
    shard, catalogue, index = (folder / name for name in ("1.zarr.zip", "catalogue.csv", "index.json"))
    write_shard(shard, ids, (_ball(hierarchy.finest.centroids, rng) for _ in ids), hierarchy.digest)
    catalogue.write_text("\n".join(["id,split", *(f"{shape},train" for shape in ids)]))
    index_fields([shard], catalogue, GridOptions.parse({"cells": cells, "depth": depth}), index)
    return FieldStore.open(index)


def _ball(points: np.ndarray, rng: np.random.Generator) -> Field:
    away = points - rng.uniform(0.3, 0.7, size=3)
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    radius = rng.uniform(0.1, 0.3)
    return Field(distance[:, 0] < radius, ((radius - distance) * away / distance).astype(np.float32))


def read_seconds(store: FieldStore, batch: int) -> float:
    """Of the reading thread, for a batch; the best of what there are."""
    fields, seconds = StreamedFields(store, "train"), []
    for rows in torch.arange(len(fields)).split(batch):
        start = perf_counter()
        fields.batch(rows)
        seconds.append(perf_counter() - start)
    return min(seconds)


def train(store: FieldStore, batch: int, width: int, device: str) -> Found:
    """Autoencoder steps over all shapes twice, without the first, which waits for its first batch."""
    options = TetganOptions.parse({"grid": "LR", "latent": "tet", "code": 16, "width": width})
    training = TetganTraining.parse({"batch_size": batch})
    operator = vertex_operator(store.hierarchy.finest)
    where = torch.device(device)
    learner = TetganLearner(
        options,
        training,
        store.hierarchy,
        operator,
        mu=store.mu / store.max_displacement,
        seed=0,
        device=where,
    )
    fields = StreamedFields(store, "train", where)
    plan = torch.arange(len(fields)).repeat(2).split(batch)
    waited, start, batches = 0.0, 0.0, fields.batches(plan)
    for number in range(len(plan)):
        asked = perf_counter()
        field = next(batches)
        if number == 0:
            start = perf_counter()
        else:
            waited += perf_counter() - asked
        learner.autoencoder_step(field, 0.5, step_draws(0, number))
        if where.type == "cuda":
            torch.cuda.synchronize()
    total = perf_counter() - start
    return Found(read_seconds(store, batch), (total - waited) / len(plan), waited / total)


def main(
    cells: Annotated[int, typer.Option(help="cells along each side of the cube")] = 2,
    depth: Annotated[int, typer.Option(help="subdivisions of the cells")] = 2,
    batch: Annotated[int, typer.Option(min=1, help="shapes a step")] = 4,
    width: Annotated[int, typer.Option(min=1, help="channels at the finest level")] = 16,
    device: Annotated[str, typer.Option(help="cpu or cuda; left out, CUDA where there is one")] = "",
) -> None:
    """Seconds of reading and of a step, and the share of waiting."""
    device = device or ("cuda" if torch.cuda.is_available() else "cpu")
    with TemporaryDirectory() as folder:
        found = train(write_balls(Path(folder), cells, depth, 8 * batch), batch, width, device)
    typer.echo(
        f"reading a batch {found.reading:.3f} s, a step {found.step:.3f} s, waiting {found.waiting:.1%}"
    )


if __name__ == "__main__":
    typer.run(main)
