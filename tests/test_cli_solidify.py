"""`tetgan solidify`, as it is called."""

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
import trimesh

from tetgan.meshing.solidify import SolidifyOptions
from tetgan.meshing.solidify_files import solidify_files
from tetgan.solids.certificate import certify
from tetgan.solids.reading import read_solid


def run(*arguments):
    command = [sys.executable, "-m", "tetgan", "solidify", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


@pytest.fixture
def folder(tmp_path):
    meshes = tmp_path / "meshes"
    (meshes / "more").mkdir(parents=True)
    trimesh.creation.box((2, 1, 1)).export(meshes / "box.ply")
    trimesh.creation.icosphere(subdivisions=2).export(meshes / "box.stl")
    trimesh.creation.cylinder(0.2, 1).export(meshes / "more" / "pipe.glb")
    (meshes / "text.obj").write_text("no mesh at all")
    (meshes / "notes.txt").write_text("not looked at")
    return meshes


def test_one_mesh_of_some_millimetres(tmp_path):
    trimesh.creation.box((40, 20, 20)).export(tmp_path / "box.stl")
    done = run(tmp_path / "box.stl", tmp_path / "box.vtu", "--units", "mm", "--edge", "0.2cm")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("box.stl: valid; ")
    solid = read_solid(tmp_path / "box.vtu")
    assert certify(solid.vertices, solid.tets).valid
    assert solid.volumes.sum() == pytest.approx(16000, rel=0.03)
    assert np.linalg.norm(np.diff(solid.vertices[solid.edges], axis=1), axis=2).max() < 2 * 2 * 2


def test_a_folder_with_one_bad_mesh(folder, tmp_path):
    done = run(folder, tmp_path / "solids", "--cells", 8, "--suffix", ".msh")
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "text.obj: no solid: " in done.stdout
    assert done.stdout.splitlines()[-1] == "3 of 4 meshes are solids now"
    found = {
        path.relative_to(tmp_path / "solids").as_posix() for path in (tmp_path / "solids").rglob("*.msh")
    }
    assert found == {"box.ply.msh", "box.stl.msh", "more/pipe.msh"}
    table = pd.read_csv(tmp_path / "solids" / "solidify.csv", keep_default_na=False)
    assert table["mesh"].tolist() == ["box.ply", "box.stl", "more/pipe.glb", "text.obj"]
    assert (table["problem"] != "").tolist() == [False, False, False, True]
    assert table["solid"].tolist() == ["box.ply.msh", "box.stl.msh", "more/pipe.msh", ""]


def test_two_workers_write_the_same_bytes(folder, tmp_path):
    options = SolidifyOptions(cells=8)
    for workers in (1, 2):
        solidify_files(folder, tmp_path / str(workers), options, workers=workers)
    names = sorted(path.name for path in (tmp_path / "1").rglob("*.vtu"))
    assert len(names) == 3
    for path in (tmp_path / "1").rglob("*.vtu"):
        assert path.read_bytes() == (tmp_path / "2" / path.relative_to(tmp_path / "1")).read_bytes()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["absent.ply", "out.vtu"], "absent.ply: no such file or folder"),
        (["empty", "out"], "empty: no meshes"),
        (["box.ply", "out.docx"], "no mesh format '.docx' to write"),
        (["box.ply", "out"], "no mesh format '' to write"),
        (["box.ply", "out.vtu", "--edge", "5mm"], "--edge: '5mm' has a unit"),
        (["box.ply", "out.vtu", "--repair", "magic"], "repair: Input should be 'auto'"),
    ],
)
def test_bad_arguments_are_one_line_and_status_2(tmp_path, monkeypatch, arguments, told):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    trimesh.creation.box().export(tmp_path / "box.ply")
    done = run(*arguments)
    assert done.returncode == 2
    assert told in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_mesh_that_takes_too_long_is_given_up_and_leaves_nothing_behind(tmp_path):
    trimesh.creation.icosphere(subdivisions=5).export(tmp_path / "ball.ply")
    (tmp_path / ".1234.partial.ball.vtu").touch()  # where the child was when it ended
    options = SolidifyOptions(timeout_seconds=0.05)
    (found,) = solidify_files(tmp_path / "ball.ply", tmp_path / "ball.vtu", options)
    assert found.problem == "solidify took longer than 0.05 s"
    assert [path.name for path in tmp_path.iterdir()] == ["ball.ply"]
