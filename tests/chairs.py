"""A small field store of made-up chairs: a seat, a back and four legs, each a box."""

from pathlib import Path

import numpy as np
import pytest

from tetgan.fields.field import Field
from tetgan.fields.store import index_fields, write_shard
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.grids.options import GridOptions

TRAIN, VALIDATION = 24, 6


def chair_field(points: np.ndarray, rng: np.random.Generator) -> Field:
    """Occupancy and closest surface points of a union of boxes (exact outside, and good enough inside)."""
    width, depth, seat, height = rng.uniform([0.5, 0.5, 0.3, 0.7], [0.9, 0.9, 0.5, 0.95])
    x, z, leg, back = width / 2, depth / 2, rng.uniform(0.12, 0.2), rng.uniform(0.12, 0.25)
    low = [[-x, seat - 0.1, -z], [-x, seat, -z]]
    high = [[x, seat + 0.08, z], [x, height, -z + back]]
    for side in (-1, 1):
        for end in (-1, 1):
            corner = np.array([side * (x - leg / 2), end * (z - leg / 2)])
            low.append([corner[0] - leg / 2, 0.05, corner[1] - leg / 2])
            high.append([corner[0] + leg / 2, seat, corner[1] + leg / 2])
    offset = np.array([0.5, 0, 0.5])
    return union_field(points, np.array(low) + offset, np.array(high) + offset)


def union_field(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> Field:
    q = points[:, None]
    gaps = np.stack([q - low, high - q])  # (2, T, boxes, 3): positive inside
    inside = (gaps > 0).all(axis=(0, 3))
    outside_offset = np.clip(q, low, high) - q
    # Inside a box the nearest wall: the smallest gap, along its axis.
    side, axis = np.unravel_index(gaps.transpose(1, 2, 0, 3).reshape(*inside.shape, 6).argmin(-1), (2, 3))
    wall = np.zeros_like(outside_offset)
    size = gaps.min(axis=(0, 3))
    np.put_along_axis(wall, axis[..., None], (np.where(side == 0, -1, 1) * size)[..., None], -1)
    offsets = np.where(inside[..., None], wall, outside_offset)
    nearest = np.linalg.norm(offsets, axis=-1).argmin(axis=1)
    chosen = np.take_along_axis(offsets, nearest[:, None, None], 1)[:, 0]
    return Field(inside.any(axis=1), chosen.astype(np.float32))


def write_index(folder: Path, depth: int) -> Path:
    """Index of 24 training and 6 validation chairs on the grid of one cell and some depth."""
    hierarchy = build_hierarchy(1, depth)
    ids = [f"chair-{number:02}" for number in range(TRAIN + VALIDATION)]
    rng = np.random.default_rng(0)
    fields = (chair_field(hierarchy.finest.centroids, rng) for _ in ids)
    shard, catalogue, out = (folder / name for name in ("1.zarr.zip", "catalogue.csv", "index.json"))
    write_shard(shard, ids, fields, hierarchy.digest)
    splits = ["train"] * TRAIN + ["validation"] * VALIDATION
    rows = [f"{shape},{split}" for shape, split in zip(ids, splits, strict=True)]
    catalogue.write_text("\n".join(["id,split", *rows]))
    index_fields([shard], catalogue, GridOptions.parse({"cells": 1, "depth": depth}), out)
    return out


@pytest.fixture(scope="session")
def index(tmp_path_factory) -> Path:
    """The chairs on 1,536 tets."""
    return write_index(tmp_path_factory.mktemp("fields"), 2)


@pytest.fixture(scope="session")
def tiny_index(tmp_path_factory) -> Path:
    """The same on 192 tets, for what has nothing to learn."""
    return write_index(tmp_path_factory.mktemp("tiny"), 1)
