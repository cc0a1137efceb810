"""The stage from a shard of meshes to a shard of fields."""

import numpy as np
import pytest

from tetgan.errors import UserError
from tetgan.fields.extraction import extract_field, extract_shard
from tetgan.fields.store import ShardReader
from tetgan.grids.options import GridOptions
from tetgan.shapes.archive import write_meshes

GRID = GridOptions(cells=2, depth=1)


def test_every_mesh_becomes_a_field(tmp_path, grid, hierarchy, ball):
    vertices, faces = ball
    meshes = {"large": vertices, "small": (vertices - 0.5) / 2 + 0.5}
    write_meshes(tmp_path / "meshes.zip", [(name, points, faces) for name, points in meshes.items()], [])
    extract_shard(tmp_path / "meshes.zip", tmp_path / "fields.zarr.zip", GRID)
    reader = ShardReader(tmp_path / "fields.zarr.zip")
    assert reader.ids == ["large", "small"]
    assert reader.grid_digest == hierarchy.digest
    for name, points in meshes.items():
        expected, read = extract_field(points, faces, grid), reader.read(name)
        np.testing.assert_array_equal(read.occupancy, expected.occupancy)
        np.testing.assert_allclose(read.displacement, expected.displacement, rtol=5e-4, atol=1e-7)


def test_a_shard_without_meshes_makes_one_without_fields(tmp_path):
    write_meshes(tmp_path / "meshes.zip", [], [{"id": "x", "status": "quarantined"}])
    extract_shard(tmp_path / "meshes.zip", tmp_path / "fields.zarr.zip", GRID)
    assert ShardReader(tmp_path / "fields.zarr.zip").ids == []


def test_no_archive_no_fields(tmp_path):
    with pytest.raises(UserError, match=r"absent\.zip"):
        extract_shard(tmp_path / "absent.zip", tmp_path / "fields.zarr.zip", GRID)
    assert list(tmp_path.iterdir()) == []
