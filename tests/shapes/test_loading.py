"""Every format, and what untrusted bytes may not do."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from soups import box, write_off

from tetgan.shapes import loading
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.loading import MESH_SUFFIXES, parse_mesh, read_file, read_zip_member


@pytest.mark.parametrize("suffix", sorted(MESH_SUFFIXES))
def test_every_format_gives_the_same_triangles(suffix: str) -> None:
    soup = box(size=(1, 2, 3))
    data = trimesh.Trimesh(soup.vertices, soup.faces, process=False).export(file_type=suffix[1:])
    loaded = parse_mesh(data.encode() if isinstance(data, str) else data, suffix)
    np.testing.assert_allclose(loaded.triangles, soup.triangles, atol=1e-6)  # some formats hold float32


def test_parts_of_a_scene_are_placed_and_joined() -> None:
    scene = trimesh.Scene()
    part = trimesh.Trimesh(box().vertices, box().faces, process=False)
    for shift in (0.0, 5.0):
        scene.add_geometry(part, transform=trimesh.transformations.translation_matrix([shift, 0, 0]))
    loaded = parse_mesh(scene.export(file_type="glb"), ".glb")
    assert len(loaded.faces) == 24
    assert np.ptp(loaded.vertices[:, 0]) == pytest.approx(6.0)


def test_polygons_of_an_off_file_are_triangulated() -> None:
    square = b"OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"
    assert parse_mesh(square, ".off").faces.shape == (2, 3)


def test_modelnet_header_without_a_line_break() -> None:
    glued = write_off(box()).replace(b"OFF\n", b"OFF", 1)
    np.testing.assert_array_equal(parse_mesh(glued, ".off").triangles, box().triangles)


def test_materials_outside_the_file_are_not_looked_for(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "evil.mtl").write_text("newmtl a\nKd 1 0 0\n")
    monkeypatch.chdir(tmp_path)

    def refuse(path: object, *_: object, **__: object) -> None:
        raise AssertionError(f"{path} was opened")

    monkeypatch.setattr("builtins.open", refuse)
    data = b"mtllib evil.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    assert len(parse_mesh(data, ".obj").faces) == 1


@settings(max_examples=40, deadline=None)
@given(data=st.binary(max_size=200), suffix=st.sampled_from(sorted(MESH_SUFFIXES)))
def test_garbage_is_a_reason_and_never_another_error(data: bytes, suffix: str) -> None:
    with pytest.raises(ShapeError):
        parse_mesh(data, suffix)


@pytest.mark.parametrize("cut", [0.1, 0.5, 0.9])
def test_a_cut_file_is_a_reason_or_fewer_faces(cut: float) -> None:
    data = write_off(box())
    try:
        assert len(parse_mesh(data[: int(cut * len(data))], ".off").faces) < 12
    except ShapeError as error:
        assert str(error)


def test_a_cloud_without_faces_is_refused() -> None:
    with pytest.raises(ShapeError, match="no faces"):
        parse_mesh(trimesh.PointCloud(box().vertices).export(file_type="ply"), ".ply")


def test_large_and_missing_files_are_refused(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(loading, "LARGEST_FILE", 10)
    (tmp_path / "large.off").write_bytes(write_off(box()))
    with pytest.raises(ShapeError, match="too large"):
        read_file(tmp_path / "large.off")
    with pytest.raises(ShapeError, match="unreadable"):
        read_file(tmp_path / "missing.off")


def test_a_zip_bomb_stops_at_the_limit(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(loading, "LARGEST_FILE", 1000)
    with zipfile.ZipFile(tmp_path / "bomb.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.obj", b"0" * 10**6)
    with pytest.raises(ShapeError, match="too large"):
        read_zip_member(tmp_path / "bomb.zip", "a.obj")


def test_bad_zips_are_refused(tmp_path: Path) -> None:
    (tmp_path / "not.zip").write_bytes(b"PK nothing")
    with zipfile.ZipFile(tmp_path / "empty.zip", "w"):
        pass
    for name in ("not.zip", "empty.zip", "missing.zip"):
        with pytest.raises(ShapeError, match="zip"):
            read_zip_member(tmp_path / name, "a.obj")


def test_nothing_pickled_is_loaded() -> None:
    buffer = io.BytesIO()
    np.save(buffer, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(ShapeError):
        parse_mesh(buffer.getvalue(), ".ply")
