"""Shards of repaired meshes on disk."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from soups import box, join

from tetgan.errors import UserError
from tetgan.shapes.archive import read_mesh, read_meshes, read_records, write_meshes

_ITEMS = [("b", box().vertices, box().faces), ("a", join(box(), box()).vertices, join(box(), box()).faces)]
_RECORDS = [
    {"id": "b", "path": "x/b.off", "sha256": "00", "split": "", "status": "ok", "reason": "", "volume": 0.1},
    {
        "id": "nan",
        "path": "001",
        "sha256": "12",
        "split": "train",
        "status": "rejected",
        "reason": "flat, 'thin'",
    },
]


def test_meshes_come_back_in_order_and_exactly(tmp_path: Path) -> None:
    write_meshes(tmp_path / "s.zip", _ITEMS, _RECORDS)
    for (wrote, vertices, faces), (read, vertices_read, faces_read) in zip(
        _ITEMS, read_meshes(tmp_path / "s.zip"), strict=True
    ):
        assert wrote == read
        np.testing.assert_array_equal(vertices, vertices_read)
        np.testing.assert_array_equal(faces, faces_read)
    assert len(read_mesh(tmp_path / "s.zip", "a").faces) == 24
    with pytest.raises(KeyError):
        read_mesh(tmp_path / "s.zip", "c")


def test_ids_and_digests_that_look_like_numbers_stay_text(tmp_path: Path) -> None:
    write_meshes(tmp_path / "s.zip", [], _RECORDS)
    records = read_records(tmp_path / "s.zip")
    assert records["id"].tolist() == ["b", "nan"]
    assert records["path"].tolist() == ["x/b.off", "001"]
    assert records["reason"].tolist() == ["", "flat, 'thin'"]
    assert records["volume"][0] == 0.1
    assert pd.isna(records["volume"][1])


def test_the_same_content_has_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one.zip", "two.zip"):
        write_meshes(tmp_path / name, _ITEMS, _RECORDS)
    assert (tmp_path / "one.zip").read_bytes() == (tmp_path / "two.zip").read_bytes()


def test_an_interrupted_shard_is_absent(tmp_path: Path) -> None:
    def items():
        yield _ITEMS[0]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_meshes(tmp_path / "s.zip", items(), [])
    assert list(tmp_path.iterdir()) == []


def test_a_shard_without_shapes_can_be_read(tmp_path: Path) -> None:
    write_meshes(tmp_path / "s.zip", [], [])
    assert list(read_meshes(tmp_path / "s.zip")) == []
    assert len(read_records(tmp_path / "s.zip")) == 0


def test_something_else_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "s.zip").write_bytes(b"no zip")
    with pytest.raises(UserError, match="not a shard"):
        list(read_meshes(tmp_path / "s.zip"))
