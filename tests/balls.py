"""Spheres and boxes with exact occupancy and signed distance, in stores like those of the pipeline."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from tetgan.fields.arrays import write_arrays
from tetgan.fields.options import PointOptions, VoxelOptions
from tetgan.fields.samplings import index_samplings
from tetgan.fields.voxels import CLAMP, cell_centres

POINTS = 4000
SPLITS = {"ball-0": "train", "ball-1": "train", "box-0": "train", "box-1": "train", "box-2": "validation"}


# Centre, then radius or half the sides.
PARTS = {
    "ball-0": ((0.5, 0.5, 0.5), 0.45),
    "ball-1": ((0.35, 0.5, 0.5), 0.3),
    "box-0": ((0.5, 0.25, 0.5), (0.45, 0.22, 0.45)),
    "box-1": ((0.75, 0.5, 0.5), (0.22, 0.45, 0.45)),
    "box-2": ((0.5, 0.7, 0.6), (0.4, 0.25, 0.3)),
}


def distance(shape_id: str, points: np.ndarray) -> np.ndarray:
    """Signed distance to a ball or a box, negative inside."""
    centre, size = PARTS[shape_id]
    offset = points - np.array(centre)
    if shape_id.startswith("ball"):
        return np.linalg.norm(offset, axis=-1) - size
    q = np.abs(offset) - np.array(size)
    return np.linalg.norm(q.clip(min=0), axis=-1) + q.max(axis=-1).clip(max=0)


class Store(NamedTuple):
    """Takes the place of a `PointStore` or a `VoxelStore`."""

    shapes: dict[str, object]
    digest: str = "made up"

    def ids(self, split: str) -> list[str]:
        return [shape_id for shape_id in self.shapes if SPLITS[shape_id] == split]

    def read(self, shape_id: str):
        return self.shapes[shape_id]


def points_of(shape_id: str) -> tuple[np.ndarray, np.ndarray]:
    draws = np.random.default_rng(len(shape_id)).random((POINTS, 3))
    points = (0.5 + 1.1 * (draws - 0.5)).astype(np.float16).astype(np.float32)
    return points, distance(shape_id, points) < 0


def voxels_of(shape_id: str, resolution: int) -> np.ndarray:
    clamped = distance(shape_id, cell_centres(resolution)).clip(-CLAMP, CLAMP)
    return clamped.astype(np.float16).astype(np.float32)


@pytest.fixture(scope="session")
def points() -> Store:
    return Store({shape_id: points_of(shape_id) for shape_id in SPLITS})


@pytest.fixture(scope="session")
def voxels() -> Store:
    return Store({shape_id: voxels_of(shape_id, 32) for shape_id in SPLITS})


@pytest.fixture(scope="session")
def coarse_voxels() -> Store:
    """Of 16 a side, without an index: what suffices for a critic to grow."""
    return Store({shape_id: voxels_of(shape_id, 16) for shape_id in SPLITS})


@pytest.fixture(scope="session")
def indexes(tmp_path_factory) -> dict[str, Path]:
    """Indexes of both as the pipeline writes them, by kind of model."""
    folder = tmp_path_factory.mktemp("samplings")
    points, voxels = PointOptions(kind="points", count=POINTS), VoxelOptions(kind="voxels", resolution=32)
    occupancy = (
        {"points": positions.astype(np.float16), "occupancy": np.packbits(inside)}
        for positions, inside in map(points_of, SPLITS)
    )
    distances = ({"distance": voxels_of(shape_id, 32).astype(np.float16)} for shape_id in SPLITS)
    catalogue = folder / "catalogue.csv"
    catalogue.write_text("\n".join(["id,split", *(",".join(row) for row in SPLITS.items())]))
    for options, shapes in ((points, occupancy), (voxels, distances)):
        shard = folder / f"{options.kind}.zarr.zip"
        attributes = {"sampling": options.model_dump(mode="json")}
        write_arrays(shard, list(SPLITS), shapes, attributes, "sampling")
        index_samplings([shard], catalogue, options, folder / f"{options.kind}.json")
    return {"occnet": folder / "points.json", "shapegan-vae": folder / "voxels.json"}
