"""Field shards on disk, and the index over them."""

import json
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.errors import UserError
from tetgan.fields.field import Field, surface_tets
from tetgan.fields.store import FieldStore, ShardReader, index_fields, write_shard
from tetgan.grids.options import GridOptions

GRID = GridOptions(cells=2, depth=1)
SHARDS = {"1-of-3": ["b", "a"], "2-of-3": [], "3-of-3": ["d", "c", "e"]}
SPLITS = {"a": "train", "b": "validation", "c": "train", "d": "validation", "e": "train"}


def random_field(tets, seed, share=0.5):
    rng = np.random.default_rng(seed)
    displacement = rng.normal(scale=0.2, size=(tets, 3)).astype(np.float32)
    return Field(rng.random(tets) < share, displacement)


def half(field):
    """What float16 keeps of a displacement."""
    return field.displacement.astype(np.float16).astype(np.float32)


def write_catalogue(path, splits):
    rows = [f"{shape_id},{split},ok" for shape_id, split in splits.items()]
    path.write_text("\n".join(["id,split,status", *rows, "held,holdout,surface", ""]))
    return path


@pytest.fixture(scope="module")
def fields(grid):
    # 'e' is empty: it has no surface tet and does not count for mu.
    return {
        shape_id: random_field(len(grid.tets), seed, share=0 if shape_id == "e" else 0.5)
        for seed, shape_id in enumerate(SPLITS)
    }


@pytest.fixture
def dataset(tmp_path, hierarchy, fields):
    """Three shards, one of them empty, with a catalogue and an index."""
    paths = []
    for name, ids in SHARDS.items():
        paths.append(tmp_path / f"{name}.zarr.zip")
        write_shard(paths[-1], ids, (fields[shape_id] for shape_id in ids), hierarchy.digest)
    index_fields(paths, write_catalogue(tmp_path / "catalogue.csv", SPLITS), GRID, tmp_path / "index.json")
    return tmp_path


@given(
    count=st.integers(0, 3),
    tets=st.integers(1, 9),
    seed=st.integers(0, 2**32 - 1),
    share=st.sampled_from([0, 0.5, 1]),
)
@settings(max_examples=15, deadline=None)
def test_what_is_written_is_read(count, tets, seed, share, tmp_path_factory):
    path = tmp_path_factory.mktemp("shard") / "1-of-1.zarr.zip"
    ids = [f"shape {number}" for number in range(count)]
    fields = [random_field(tets, seed + number, share) for number in range(count)]
    write_shard(path, ids, fields, "digest")
    reader = ShardReader(path)
    assert reader.ids == ids
    assert reader.grid_digest == "digest"
    for shape_id, field in zip(ids, fields, strict=True):
        read = reader.read(shape_id)
        np.testing.assert_array_equal(read.occupancy, field.occupancy)
        np.testing.assert_array_equal(read.displacement, half(field))


def test_the_same_fields_give_the_same_bytes(tmp_path, monkeypatch, fields):
    for name, clock in (("one", 1e9), ("other", 1.5e9)):
        monkeypatch.setattr("time.time", lambda clock=clock: clock)
        write_shard(tmp_path / name, list(fields), fields.values(), "digest")
    assert (tmp_path / "one").read_bytes() == (tmp_path / "other").read_bytes()


def test_no_entry_is_written_twice(dataset):
    names = zipfile.ZipFile(dataset / "3-of-3.zarr.zip").namelist()
    assert len(names) == len(set(names))
    assert {"displacement/c/0/0/0", "displacement/c/1/0/0", "displacement/c/2/0/0"} <= set(names)


@pytest.mark.parametrize("given_ids", [["a"], ["a", "b", "c"]])
def test_a_shard_that_fails_leaves_no_file(tmp_path, fields, given_ids):
    with pytest.raises(ValueError, match="2 fields for"):
        write_shard(tmp_path / "bad.zarr.zip", given_ids, [fields["a"], fields["b"]], "digest")
    assert list(tmp_path.iterdir()) == []


def test_the_store_opens_shards_as_one(dataset, hierarchy, fields):
    store = FieldStore.open(dataset / "index.json")
    assert store.ids("train") == ["a", "c", "e"]
    assert store.ids("validation") == ["b", "d"]
    assert store.grid == GRID
    assert store.hierarchy.digest == hierarchy.digest
    for shape_id, field in fields.items():
        read = store.read(shape_id)
        np.testing.assert_array_equal(read.occupancy, field.occupancy)
        np.testing.assert_array_equal(read.displacement, half(field))


def test_mu_and_the_largest_displacement_are_of_the_training_shapes(dataset, grid, fields):
    store = FieldStore.open(dataset / "index.json")
    lengths = {shape_id: np.linalg.norm(half(field), axis=1) for shape_id, field in fields.items()}
    means = [
        lengths[shape_id][surface_tets(fields[shape_id].occupancy, grid.neighbors)].mean()
        for shape_id in ("a", "c")
    ]
    assert store.mu == pytest.approx(np.mean(means), rel=1e-6)
    assert store.max_displacement == pytest.approx(max(lengths[i].max() for i in ("a", "c", "e")), rel=1e-6)


def test_batches_are_stacked_in_the_order_asked(dataset, grid):
    store = FieldStore.open(dataset / "index.json")
    ids = ["d", "a"]
    batch, tensor = store.stack(ids), store.tensor(ids)
    for row, shape_id in enumerate(ids):
        field = store.read(shape_id)
        np.testing.assert_array_equal(batch.occupancy[row], field.occupancy)
        np.testing.assert_array_equal(batch.displacement[row], field.displacement)
    np.testing.assert_array_equal(tensor[..., 0], batch.occupancy)
    scaled = np.clip(batch.displacement / store.max_displacement, -1, 1)
    np.testing.assert_allclose(tensor[..., 1:], scaled, rtol=1e-6)
    assert store.stack([]).occupancy.shape == (0, len(grid.tets))
    assert store.tensor([]).shape == (0, len(grid.tets), 4)


def test_the_index_does_not_depend_on_the_working_folder(dataset, monkeypatch, tmp_path_factory):
    index = json.loads((dataset / "index.json").read_text())
    assert [entry["file"] for entry in index["shards"]] == [f"{name}.zarr.zip" for name in SHARDS]
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    FieldStore.open(dataset / "index.json").read("a")


def flip_a_byte(data):
    # Inside the payload of a chunk, which the zip's checksum covers.
    middle = data.index(b"displacement/c/0/0/0") + 200
    return data[:middle] + bytes([data[middle] ^ 255]) + data[middle + 1 :]


@pytest.mark.parametrize(
    "damage",
    [
        flip_a_byte,
        lambda data: data[: len(data) // 2],
        lambda data: b"",
        lambda data: b"not a zip",
        lambda data: data.replace(b'"grid_digest"', b'"grid_eigest"'),
        lambda data: data.replace(b"displacement/", b"displacemend/"),
    ],
    ids=["flipped byte", "half a file", "empty", "text", "attribute gone", "array gone"],
)
def test_a_damaged_shard_is_one_line(dataset, damage):
    path = dataset / "3-of-3.zarr.zip"
    path.write_bytes(damage(path.read_bytes()))
    store = FieldStore.open(dataset / "index.json")
    with pytest.raises(UserError, match=r"^[^\n]*3-of-3\.zarr\.zip: not a whole field shard[^\n]*again$"):
        store.stack(["c", "d", "e"])


def test_a_missing_shard_is_one_line(dataset):
    (dataset / "1-of-3.zarr.zip").unlink()
    with pytest.raises(UserError, match=r"1-of-3\.zarr\.zip: not a whole field shard"):
        FieldStore.open(dataset / "index.json").read("a")


def test_a_shard_written_anew_with_other_shapes_is_noticed(dataset, hierarchy, fields):
    write_shard(dataset / "1-of-3.zarr.zip", ["a"], [fields["a"]], hierarchy.digest)
    with pytest.raises(UserError, match=r"1-of-3\.zarr\.zip has changed since"):
        FieldStore.open(dataset / "index.json").read("a")


def test_another_grid_is_noticed(dataset, tmp_path_factory):
    out = tmp_path_factory.mktemp("other") / "index.json"
    with pytest.raises(UserError, match="made on another grid"):
        index_fields(
            [dataset / "1-of-3.zarr.zip"], dataset / "catalogue.csv", GridOptions(cells=1, depth=1), out
        )
    assert not out.exists()


@pytest.mark.parametrize(
    ("shards", "splits", "problem"),
    [
        (["1-of-3", "3-of-3"], {"a": "train"}, "shape 'b' is not in"),
        (["1-of-3", "copy"], SPLITS, "also stands in another shard"),
        (["2-of-3"], SPLITS, "no training shape"),
        (["1-of-3"], {"a": "validation", "b": "validation"}, "no training shape"),
        ([], SPLITS, "no training shape"),
    ],
)
def test_shards_that_do_not_fit_together_are_one_line(dataset, shards, splits, problem):
    (dataset / "copy.zarr.zip").write_bytes((dataset / "1-of-3.zarr.zip").read_bytes())
    catalogue = write_catalogue(dataset / "other.csv", splits)
    paths = [dataset / f"{name}.zarr.zip" for name in shards]
    with pytest.raises(UserError) as raised:
        index_fields(paths, catalogue, GRID, dataset / "other.json")
    assert problem in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("text", [None, "", "{", '{"mu": 1}', "[]"])
def test_a_bad_index_is_one_line(tmp_path, text):
    if text is not None:
        (tmp_path / "index.json").write_text(text)
    with pytest.raises(UserError, match=r"^[^\n]*not an index of fields[^\n]*$"):
        FieldStore.open(tmp_path / "index.json")


@pytest.mark.parametrize("text", [None, "name,split\nx,train\n", "id\na\n"])
def test_a_bad_catalogue_is_one_line(dataset, text):
    path = dataset / "bad.csv"
    if text is not None:
        path.write_text(text)
    with pytest.raises(UserError, match=r"^[^\n]*not a catalogue with columns id and split[^\n]*$"):
        index_fields([dataset / "1-of-3.zarr.zip"], path, GRID, dataset / "other.json")
