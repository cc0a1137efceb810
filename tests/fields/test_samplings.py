"""Points and voxels on disk: stage, index, and reading both back."""

import zlib

import numpy as np
import pytest

from tetgan.errors import UserError
from tetgan.fields.options import PointOptions, VoxelOptions
from tetgan.fields.points import draw_points
from tetgan.fields.samplings import PointStore, VoxelStore, extract_samplings, index_samplings
from tetgan.fields.voxels import sample_distance
from tetgan.shapes.archive import write_meshes

POINTS = PointOptions(kind="points", count=1001)  # no multiple of eight
VOXELS = VoxelOptions(kind="voxels", resolution=32)
SHARDS = {"1-of-3": ["b", "a"], "2-of-3": [], "3-of-3": ["c"]}
SPLITS = {"a": "train", "b": "validation", "c": "train"}


@pytest.fixture(scope="module")
def meshes(tmp_path_factory, ball):
    """Three archives of balls of several sizes, one of them empty, and their catalogue."""
    folder = tmp_path_factory.mktemp("meshes")
    vertices, faces = ball
    sizes = {"a": 0.5, "b": 0.75, "c": 1.0}
    for name, ids in SHARDS.items():
        shapes = [(shape_id, sizes[shape_id] * (vertices - 0.5) + 0.5, faces) for shape_id in ids]
        write_meshes(folder / f"{name}.zip", shapes, [])
    rows = [f"{shape_id},{split}" for shape_id, split in SPLITS.items()]
    (folder / "catalogue.csv").write_text("\n".join(["id,split", *rows, "held,holdout", ""]))
    return folder, {shape_id: (size * (vertices - 0.5) + 0.5, faces) for shape_id, size in sizes.items()}


def sample(meshes, folder, options):
    """The index of a sampling of those archives."""
    shards = [folder / f"{name}.zarr.zip" for name in SHARDS]
    for name, shard in zip(SHARDS, shards, strict=True):
        extract_samplings(meshes / f"{name}.zip", shard, options)
    index_samplings(shards, meshes / "catalogue.csv", options, folder / "index.json")
    return folder / "index.json"


@pytest.fixture(scope="module")
def points(tmp_path_factory, meshes):
    return sample(meshes[0], tmp_path_factory.mktemp("points"), POINTS)


@pytest.fixture(scope="module")
def voxels(tmp_path_factory, meshes):
    return sample(meshes[0], tmp_path_factory.mktemp("voxels"), VOXELS)


def test_points_come_back(points, meshes):
    store = PointStore.open(points)
    assert store.ids("train") == ["a", "c"]
    assert store.ids("validation") == ["b"]
    assert (store.options, store.box) == (POINTS, 1.1)
    for shape_id, mesh in meshes[1].items():
        expected = draw_points(*mesh, 1001, 1.1, (0, zlib.crc32(shape_id.encode())))
        for got, want in zip(store.read(shape_id), expected, strict=True):
            np.testing.assert_array_equal(got, want)
            assert got.dtype == want.dtype


def test_shapes_have_points_of_their_own(points):
    store = PointStore.open(points)
    assert not np.array_equal(store.read("a")[0], store.read("b")[0])


def test_voxels_come_back(voxels, meshes):
    store = VoxelStore.open(voxels)
    assert (store.options, store.resolution) == (VOXELS, 32)
    for shape_id, mesh in meshes[1].items():
        distance = store.read(shape_id)
        assert distance.dtype == np.float32
        np.testing.assert_allclose(distance, sample_distance(*mesh, 32), atol=5e-5)


def test_the_same_meshes_give_the_same_bytes_and_digest(points, tmp_path, meshes):
    again = sample(meshes[0], tmp_path, POINTS)
    for name in SHARDS:
        one, other = (path.with_name(f"{name}.zarr.zip").read_bytes() for path in (points, again))
        assert one == other
    assert PointStore.open(again).digest == PointStore.open(points).digest


def test_the_digest_follows_options_content_and_split(points, tmp_path, meshes):
    digests = {PointStore.open(points).digest}
    digests.add(PointStore.open(sample(meshes[0], tmp_path, PointOptions(kind="points", count=7))).digest)
    shards = [points.with_name(f"{name}.zarr.zip") for name in SHARDS]
    (tmp_path / "other.csv").write_text("id,split\na,train\nb,train\nc,train\n")
    index_samplings(shards, tmp_path / "other.csv", POINTS, tmp_path / "other.json")
    digests.add(PointStore.open(tmp_path / "other.json").digest)
    index_samplings([shards[0]], meshes[0] / "catalogue.csv", POINTS, tmp_path / "fewer.json")
    digests.add(PointStore.open(tmp_path / "fewer.json").digest)
    assert len(digests) == 4


def test_an_index_of_another_kind_is_one_line(points, voxels):
    with pytest.raises(UserError, match=r"^[^\n]*index of points; name another sampling$"):
        VoxelStore.open(points)
    with pytest.raises(UserError, match=r"^[^\n]*index of voxels; name another sampling$"):
        PointStore.open(voxels)


def test_shards_made_with_other_options_are_noticed(points, meshes, tmp_path):
    shard = points.with_name("1-of-3.zarr.zip")
    other = PointOptions(kind="points", count=1001, seed=1)
    with pytest.raises(UserError, match="made with other options"):
        index_samplings([shard], meshes[0] / "catalogue.csv", other, tmp_path / "index.json")


def test_a_damaged_shard_is_one_line(meshes, tmp_path):
    index = sample(meshes[0], tmp_path, VOXELS)
    shard = index.with_name("3-of-3.zarr.zip")
    shard.write_bytes(shard.read_bytes()[:1000])
    with pytest.raises(UserError, match=r"^[^\n]*3-of-3\.zarr\.zip: not a whole sampling shard[^\n]*again$"):
        VoxelStore.open(index).read("c")


def test_no_training_shape_is_one_line(points, tmp_path):
    (tmp_path / "catalogue.csv").write_text("id,split\na,validation\nb,validation\nc,validation\n")
    shards = [points.with_name(f"{name}.zarr.zip") for name in SHARDS]
    with pytest.raises(UserError, match="no training shape"):
        index_samplings(shards, tmp_path / "catalogue.csv", POINTS, tmp_path / "index.json")
