"""Adaptors on made-up folders of each layout."""

import hashlib
import zipfile
from pathlib import Path

import numpy as np
import pytest
from soups import box, write_off

from tetgan.errors import UserError
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.options import (
    BuiltinSource,
    CosegSource,
    DirectorySource,
    ModelNetSource,
    ShapeNetSource,
    SweetHome3DSource,
)
from tetgan.shapes.sources import digest_shape, list_shapes, load_shape

_OBJ = b"v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n"


def _place(path: Path, data: bytes | None = None) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(write_off(box()) if data is None else data)


def test_a_directory_is_walked_and_names_are_unique(tmp_path: Path) -> None:
    for name in ("a.off", "deep/er/a.off", "deep/b.OFF", ".hidden.off", ".git/c.off", "notes.txt", "d.obj"):
        _place(tmp_path / name, _OBJ if name.endswith("obj") else None)
    source = DirectorySource(kind="directory", path=tmp_path)
    entries = list_shapes(source, "chair")
    assert [entry.id for entry in entries] == ["a", "d", "deep-b", "deep-er-a"]
    assert {entry.split for entry in entries} == {None}
    for entry in entries:
        assert len(load_shape(source, "chair", entry).faces) in {4, 12}
        assert (
            digest_shape(source, "chair", entry)
            == hashlib.sha256((tmp_path / entry.path).read_bytes()).hexdigest()
        )


def test_a_directory_can_be_narrowed_and_limited(tmp_path: Path) -> None:
    for name in ("x/chair/1.off", "y/chair/1.off", "y/table/1.off", "y/chair/2.off"):
        _place(tmp_path / name)
    source = DirectorySource(kind="directory", path=tmp_path, include="*/chair/*")
    assert [entry.id for entry in list_shapes(source, "chair")] == ["x-chair-1", "y-chair-1", "y-chair-2"]
    limited = source.model_copy(update={"limit": 2})
    assert len(list_shapes(limited, "chair")) == 2


def test_z_up_files_are_stood_upright(tmp_path: Path) -> None:
    _place(tmp_path / "a.obj", _OBJ)
    source = DirectorySource(kind="directory", path=tmp_path, up="z")
    soup = load_shape(source, "chair", list_shapes(source, "chair")[0])
    np.testing.assert_allclose(np.ptp(soup.vertices, axis=0), [1, 3, 2])
    volume = np.linalg.det(soup.triangles).sum() / 6
    assert volume == pytest.approx(-1.0)  # as in the file: the turn is no mirror


@pytest.mark.parametrize("mesh", ["model.obj", "models/model_normalized.obj"])
def test_both_layouts_of_shapenet(tmp_path: Path, mesh: str) -> None:
    for model in ("aa", "bb", "cc", "dd"):
        _place(tmp_path / "03001627" / model / mesh, _OBJ)
    (tmp_path / "03001627" / "no-mesh").mkdir()
    (tmp_path / "all.csv").write_text(
        "id,synsetId,subSynsetId,modelId,split\n"
        "1,3001627,x,aa,train\n2,03001627,x,bb,val\n3,03001627,x,cc,test\n4,04379243,x,dd,train\n"
    )
    source = ShapeNetSource(kind="shapenet", path=tmp_path)
    splits = {entry.id: entry.split for entry in list_shapes(source, "chair")}
    assert splits == {"aa": "train", "bb": "validation", "cc": "validation", "dd": None}
    seeded = source.model_copy(update={"split": "seeded"})
    assert {entry.split for entry in list_shapes(seeded, "chair")} == {None}
    assert len(load_shape(source, "chair", list_shapes(source, "chair")[0]).faces) == 4


def test_shapenet_wants_a_synset_for_an_unknown_category(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="synset"):
        list_shapes(ShapeNetSource(kind="shapenet", path=tmp_path), "spoon")


def test_coseg_takes_shapes_and_leaves_labels(tmp_path: Path) -> None:
    for name in ("Vases/shapes/1.off", "Vases/gt/1.off", "Large-Vases/shapes/1.off", "Chairs/shapes/1.off"):
        _place(tmp_path / name)
    ids = [entry.id for entry in list_shapes(CosegSource(kind="coseg", path=tmp_path), "vase")]
    assert ids == ["Large-Vases-1", "Vases-1"]


def test_modelnet_has_its_own_split_and_is_stood_upright(tmp_path: Path) -> None:
    glued = write_off(box(size=(1, 2, 3))).replace(b"OFF\n", b"OFF", 1)
    for name in ("train/chair_0001.off", "train/chair_0002.off", "test/chair_0003.off"):
        _place(tmp_path / "chair" / name, glued)
    source = ModelNetSource(kind="modelnet", path=tmp_path)
    entries = list_shapes(source, "chair")
    assert {entry.id: entry.split for entry in entries} == {
        "chair_0001": "train",
        "chair_0002": "train",
        "chair_0003": "validation",
    }
    np.testing.assert_allclose(np.ptp(load_shape(source, "chair", entries[0]).vertices, axis=0), [1, 3, 2])


def _library(path: Path, items: list[dict[str, str]]) -> None:
    lines = [
        f"{key}#{number} = {value}" for number, item in enumerate(items, 1) for key, value in item.items()
    ]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("PluginFurnitureCatalog.properties", "\n".join(lines))
        for name in {item["model"].lstrip("/") for item in items}:
            archive.writestr(name, _OBJ)


def test_sweethome3d_goes_by_the_words_of_a_name(tmp_path: Path) -> None:
    items = {
        "/m/armchair.obj": ("Modern armchair", "Living room"),
        "/m/wheel.obj": ("Wheelchair", "Miscellaneous"),
        "/m/seat.obj": ("Seat Leon", "Vehicles"),
        "/m/toy.obj": ("Toy car", "Miscellaneous"),
        "/m/fan.obj": ("Table fan", "Lights"),
        "/m/desk.obj": ("Wooden desk", "Office"),
    }
    rows = [{"name": name, "category": section, "model": model} for model, (name, section) in items.items()]
    _library(tmp_path / "Lib.sh3f", [*rows, rows[0]])
    source = SweetHome3DSource(kind="sweethome3d", path=tmp_path)
    found = {
        category: [e.id for e in list_shapes(source, category)] for category in ("chair", "car", "table")
    }
    assert found == {"chair": ["Lib-armchair"], "car": ["Lib-seat"], "table": ["Lib-desk"]}


def test_sweethome3d_turns_models_and_digests_what_it_reads(tmp_path: Path) -> None:
    rotation = "0 0 1 0 1 0 -1 0 0"
    _library(tmp_path / "Lib.sh3f", [{"name": "Vase", "model": "/v.obj", "modelRotation": rotation}])
    source = SweetHome3DSource(kind="sweethome3d", path=tmp_path)
    (entry,) = list_shapes(source, "vase")
    np.testing.assert_allclose(np.ptp(load_shape(source, "vase", entry).vertices, axis=0), [3, 2, 1])
    assert digest_shape(source, "vase", entry) == hashlib.sha256(_OBJ).hexdigest()


def test_a_model_named_out_of_its_zip_stays_inside(tmp_path: Path) -> None:
    _place(tmp_path / "secret.obj", _OBJ)
    libraries = tmp_path / "libraries"
    libraries.mkdir()
    with zipfile.ZipFile(libraries / "Lib.sh3f", "w") as archive:
        archive.writestr(
            "PluginFurnitureCatalog.properties",
            "name#1=Chair\nmodel#1=../secret.obj\nname#2=Chair\nmodel#2=/../../x.obj\n",
        )
    source = SweetHome3DSource(kind="sweethome3d", path=libraries)
    for entry in list_shapes(source, "chair"):
        assert "/" not in entry.id and ".." not in entry.id
        with pytest.raises(ShapeError, match="zip member"):
            load_shape(source, "chair", entry)
        assert digest_shape(source, "chair", entry) == ""


def test_a_damaged_library_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "Bad.sh3f").write_bytes(b"no zip")
    _library(tmp_path / "Good.sh3f", [{"name": "Chair", "model": "c.obj"}])
    entries = list_shapes(SweetHome3DSource(kind="sweethome3d", path=tmp_path), "chair")
    assert [entry.id for entry in entries] == ["Good-c"]


def test_builtin_shapes_are_the_same_every_time() -> None:
    source = BuiltinSource(kind="builtin", count=3, holdout=2)
    entries = list_shapes(source, "vase")
    assert [entry.split for entry in entries] == [None, None, None, "holdout", "holdout"]
    assert [entry.id for entry in entries] == [f"vase-{index:05d}" for index in range(5)]
    digests = [digest_shape(source, "vase", entry) for entry in entries]
    assert len(set(digests)) == 5
    assert digests == [digest_shape(source, "vase", entry) for entry in entries]


def test_an_empty_or_missing_root_is_one_clear_line(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"sources\.chair: no directory mesh"):
        list_shapes(DirectorySource(kind="directory", path=tmp_path), "chair")
    with pytest.raises(UserError, match=r"sources\.chair\.path"):
        list_shapes(DirectorySource(kind="directory", path=tmp_path / "missing"), "chair")
    with pytest.raises(UserError, match="built-in"):
        list_shapes(BuiltinSource(kind="builtin"), "spoon")
