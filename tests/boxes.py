"""A store of six training and two validation boxes on 192 tets."""

import numpy as np
import pytest

from tetgan.fields.field import Field
from tetgan.fields.store import FieldStore, index_fields, write_shard
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.grids.options import GridOptions


def box_field(points: np.ndarray, half: np.ndarray) -> Field:
    """An axis-parallel box about the middle of the cube; displacement to its faces, clipped to the box."""
    offset = points - 0.5
    inside = (np.abs(offset) < half).all(axis=1)
    axis = (half - np.abs(offset)).argmin(axis=1)
    nearest = np.clip(offset, -half, half)
    rows = np.arange(len(points))
    nearest[rows, axis] = np.where(offset[rows, axis] < 0, -1, 1) * half[axis]
    return Field(inside, (nearest - offset).astype(np.float32))


@pytest.fixture(scope="session")
def store(tmp_path_factory) -> FieldStore:
    folder = tmp_path_factory.mktemp("boxes")
    hierarchy = build_hierarchy(1, 1)
    halves = np.random.default_rng(0).uniform(0.2, 0.45, (8, 3))
    ids = [f"box-{number}" for number in range(8)]
    fields = (box_field(hierarchy.finest.centroids, half) for half in halves)
    shard, catalogue, out = (folder / name for name in ("1.zarr.zip", "catalogue.csv", "index.json"))
    write_shard(shard, ids, fields, hierarchy.digest)
    rows = [f"{shape},{'train' if number < 6 else 'validation'}" for number, shape in enumerate(ids)]
    catalogue.write_text("\n".join(["id,split", *rows]))
    index_fields([shard], catalogue, GridOptions.parse({"cells": 1, "depth": 1}), out)
    return FieldStore.open(out)
