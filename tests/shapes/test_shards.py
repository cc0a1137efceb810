"""A folder of meshes becomes a catalogue and clouds; a bad mesh never stops a category."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from soups import box, join, without_side, write_off

from tetgan.errors import UserError
from tetgan.shapes import shards
from tetgan.shapes.archive import read_meshes, read_records
from tetgan.shapes.catalogue import gather_catalogue, read_catalogue
from tetgan.shapes.cloud_sampling import sample_clouds
from tetgan.shapes.clouds import read_clouds
from tetgan.shapes.entries import ShapeEntry
from tetgan.shapes.isolation import RepairWorker
from tetgan.shapes.options import BuiltinSource, DirectorySource, RepairOptions, SplitOptions
from tetgan.shapes.shards import repair_shard, shard_entries

_REPAIR = RepairOptions(alpha=0.1, offset=0.005)
_NAN = b"OFF\n4 4 0\n0 0 0\n1 0 nan\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n"
_COLLINEAR = b"OFF\n4 2 0\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n3 0 1 2\n3 1 2 3\n"


@pytest.fixture(scope="module")
def source(tmp_path_factory) -> DirectorySource:
    """Seven good shapes, one hollow, four broken."""
    root = tmp_path_factory.mktemp("meshes")
    for number in range(7):
        soup = join(box(size=(1, 1 + number / 10, 1)), box(size=(0.2, 3, 0.2)))
        (root / f"good-{number}.off").write_bytes(write_off(soup))
    (root / "hollow.off").write_bytes(write_off(without_side(box(), axis=1, side=0)))
    (root / "nan.off").write_bytes(_NAN)
    (root / "line.off").write_bytes(_COLLINEAR)
    (root / "empty.obj").write_bytes(b"")
    (root / "garbage.ply").write_bytes(b"ply\n\x00\xff")
    return DirectorySource(kind="directory", path=root)


@pytest.fixture(scope="module")
def zips(source: DirectorySource, tmp_path_factory) -> list[Path]:
    folder = tmp_path_factory.mktemp("shards")
    paths = [folder / f"{shard}.zip" for shard in ("1-of-2", "2-of-2")]
    for path in paths:
        repair_shard("chair", source, _REPAIR, margin=0.02, shard=path.stem, out=path)
    return paths


@pytest.fixture(scope="module")
def catalogue(zips: list[Path], tmp_path_factory) -> pd.DataFrame:
    path = tmp_path_factory.mktemp("catalogue") / "catalogue.csv"
    gather_catalogue(zips, SplitOptions(), path)
    return read_catalogue(path).set_index("id")


def test_every_shape_has_a_row_and_the_reason_it_deserves(catalogue: pd.DataFrame) -> None:
    assert catalogue["status"].value_counts().to_dict() == {"ok": 7, "rejected": 4, "filled": 1}
    assert catalogue.loc["hollow", "status"] == "filled"
    assert catalogue.loc["hollow", "filled_share"] > 0.5
    reasons = catalogue["reason"]
    assert reasons["nan"] == "coordinates not finite"
    assert reasons["line"] == "no face with an area"
    assert reasons["empty"].startswith("unreadable mesh") or reasons["empty"] == "no faces"
    assert reasons["garbage"].startswith("unreadable mesh")
    assert (catalogue["sha256"].str.len() == 64).all()
    assert catalogue.index.is_monotonic_increasing


def test_shards_together_hold_each_repaired_shape_once_and_normalised(
    zips: list[Path], catalogue: pd.DataFrame
) -> None:
    meshes = [mesh for path in zips for mesh in read_meshes(path)]
    ids = [shape_id for shape_id, _, _ in meshes]
    assert sorted(ids) == sorted(catalogue.index[catalogue["status"].isin(["ok", "filled"])])
    for _, vertices, faces in meshes:
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        np.testing.assert_allclose((low + high) / 2, 0.5, atol=1e-12)
        assert (high - low).max() == pytest.approx(0.96, abs=1e-12)
        assert faces.max() == len(vertices) - 1


def test_a_shard_is_the_same_when_made_again(
    source: DirectorySource, zips: list[Path], tmp_path: Path
) -> None:
    repair_shard("chair", source, _REPAIR, margin=0.02, shard="1-of-2", out=tmp_path / "again.zip")
    for (_, *first), (_, *again) in zip(
        read_meshes(zips[0]), read_meshes(tmp_path / "again.zip"), strict=True
    ):
        for one, other in zip(first, again, strict=True):
            np.testing.assert_array_equal(one, other)
    first, again = (read_records(path).drop(columns="seconds") for path in (zips[0], tmp_path / "again.zip"))
    pd.testing.assert_frame_equal(first, again)


def test_the_split_does_not_depend_on_repair_and_clouds_agree(
    source: DirectorySource, catalogue: pd.DataFrame, tmp_path: Path
) -> None:
    assert catalogue["split"].value_counts().to_dict() == {"train": 10, "validation": 2}
    out = tmp_path / "clouds.npz"
    sample_clouds(
        "chair", source, SplitOptions(), points=50, train=99, holdout=99, margin=0.02, seed=0, out=out
    )
    clouds = read_clouds(out)
    usable = catalogue[catalogue["status"] != "rejected"]
    assert clouds.train_ids == usable.index[usable["split"] == "train"].tolist()
    assert clouds.holdout_ids == usable.index[usable["split"] == "validation"].tolist()
    assert clouds.train.shape == (len(clouds.train_ids), 50, 3)
    assert clouds.train.min() >= 0.02 - 1e-6 and clouds.train.max() <= 0.98 + 1e-6


def test_a_cloud_depends_on_its_shape_and_the_seed_alone(source: DirectorySource, tmp_path: Path) -> None:
    def clouds(name: str, **changes: int):
        wanted = {"points": 20, "train": 99, "holdout": 1, "margin": 0.0, "seed": 0} | changes
        sample_clouds("chair", source, SplitOptions(), **wanted, out=tmp_path / name)
        return read_clouds(tmp_path / name)

    full, few, other = clouds("full"), clouds("few", train=3), clouds("other", seed=1)
    assert len(few.train_ids) == 3
    for shape_id, cloud in zip(few.train_ids, few.train, strict=True):
        np.testing.assert_array_equal(cloud, full.train[full.train_ids.index(shape_id)])
    assert (other.train != full.train).any()
    clouds("again")
    assert (tmp_path / "again").read_bytes() == (tmp_path / "full").read_bytes()


def test_holdout_shapes_are_listed_and_sampled_but_not_repaired(tmp_path: Path) -> None:
    source = BuiltinSource(kind="builtin", count=2, holdout=3)
    repair_shard(
        "table", source, RepairOptions(alpha=0.1), margin=0.02, shard="1-of-1", out=tmp_path / "s.zip"
    )
    records = read_records(tmp_path / "s.zip")
    assert records["status"].tolist() == ["ok", "ok", "surface", "surface", "surface"]
    assert len(list(read_meshes(tmp_path / "s.zip"))) == 2
    out = tmp_path / "c.npz"
    sample_clouds(
        "table", source, SplitOptions(), points=30, train=2, holdout=3, margin=0.02, seed=0, out=out
    )
    assert len(read_clouds(out).holdout_ids) == 3


def test_a_crash_costs_its_mesh_and_not_the_shard(
    source: DirectorySource, monkeypatch, tmp_path: Path
) -> None:
    program = (sys.executable, "-c", "import os; os.abort()")
    monkeypatch.setattr(shards, "RepairWorker", lambda options: RepairWorker(options, program))
    repair_shard("chair", source, _REPAIR, margin=0.02, shard="1-of-4", out=tmp_path / "s.zip")
    records = read_records(tmp_path / "s.zip")
    assert records["status"].tolist() == ["rejected"] * 3
    assert records["reason"].str.contains("crashed").any()
    with pytest.raises(UserError, match="no shape could be repaired; the commonest reason"):
        gather_catalogue([tmp_path / "s.zip"], SplitOptions(), tmp_path / "catalogue.csv")


def test_an_unforeseen_error_is_a_row(source: DirectorySource, monkeypatch, tmp_path: Path) -> None:
    def surprise(*_: object) -> None:
        raise ZeroDivisionError("two\nlines")

    monkeypatch.setattr(shards, "repair_shape", surprise)
    repair_shard("chair", source, _REPAIR, margin=0.02, shard="1-of-6", out=tmp_path / "s.zip")
    assert "ZeroDivisionError: two lines" in read_records(tmp_path / "s.zip")["reason"].tolist()


def test_the_same_shape_twice_is_noticed(zips: list[Path], tmp_path: Path) -> None:
    with pytest.raises(UserError, match="two shards"):
        gather_catalogue([zips[0], zips[0]], SplitOptions(), tmp_path / "catalogue.csv")


@settings(deadline=None)
@given(count=st.integers(0, 50), parts=st.integers(1, 20))
def test_shards_partition_the_list(count: int, parts: int) -> None:
    entries = [ShapeEntry(f"{number:03d}", "") for number in range(count)]
    union = [entry for part in range(parts) for entry in shard_entries(entries, f"{part + 1}-of-{parts}")]
    assert sorted(union) == entries


@pytest.mark.parametrize("shard", ["0-of-4", "5-of-4", "4", "a-of-b", "-1-of-4", "1-of-4 "])
def test_a_shard_is_written_as_three_of_sixteen(shard: str) -> None:
    with pytest.raises(UserError, match="3-of-16"):
        shard_entries([], shard)


@pytest.mark.parametrize("content", ["garbage", "id,shape\na,b\n", "", "a,b\n1,2,3\n1,2,3,4\n"])
def test_a_file_that_is_no_catalogue_is_named(tmp_path: Path, content: str) -> None:
    (tmp_path / "other.csv").write_text(content)
    with pytest.raises(
        UserError, match=r"other\.csv: not a catalogue .*; make it with 'tetgan gather-catalogue'"
    ):
        read_catalogue(tmp_path / "other.csv")


def test_damaged_clouds_are_named(tmp_path: Path) -> None:
    for content in (b"garbage", b"PK\x03\x04 cut off"):
        (tmp_path / "clouds.npz").write_bytes(content)
        with pytest.raises(UserError, match=r"clouds\.npz: not a file of clouds"):
            read_clouds(tmp_path / "clouds.npz")
