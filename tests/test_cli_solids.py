"""`tetgan certify` and `tetgan export`, as they are called."""

import json
import subprocess
import sys

import meshio
import numpy as np
import pandas as pd
import pytest

from tetgan.geometry.adjacency import boundary_faces
from tetgan.solids.export import write_tets
from tetgan.solids.solid import SolidMesh

CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TET = np.array([[0, 1, 2, 3]])


@pytest.fixture
def folder(tmp_path):
    """A valid tet, one in a folder of its own that is inverted, and a surface."""
    write_tets(tmp_path / "meshes" / "good.vtu", SolidMesh(CORNER, TET, boundary_faces(TET)))
    turned = TET[:, [1, 0, 2, 3]]
    write_tets(tmp_path / "meshes" / "more" / "bad.msh", SolidMesh(CORNER, turned, boundary_faces(turned)))
    (tmp_path / "meshes" / "surface.ply").write_text("no tets")
    return tmp_path / "meshes"


def run(*arguments):
    command = [sys.executable, "-m", "tetgan", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def test_a_folder_is_certified(folder, tmp_path):
    done = run("certify", folder, "--out", tmp_path / "out")
    assert done.returncode == 1, done.stderr
    good, bad, total = done.stdout.splitlines()
    assert good.startswith(f"{folder}/good.vtu: valid; 1 tets, dihedral angles from 54.74 degrees")
    assert f"{folder}/more/bad.msh: not valid: 1 inverted tets" in bad
    assert total == "1 of 2 meshes are valid"
    table = pd.read_csv(tmp_path / "out" / "certificate.csv")
    assert table[["mesh", "valid", "inverted_tets"]].to_numpy().tolist() == [
        ["good.vtu", True, 0],
        ["more/bad.msh", False, 1],
    ]
    found = json.loads((tmp_path / "out" / "more" / "bad.msh.json").read_text())
    assert (found["valid"], found["reasons"]) == (False, ["1 inverted tets"])
    assert sum(found["radius_ratios"]) == 1


def test_valid_meshes_exit_with_0_and_export_keeps_them_valid(folder, tmp_path):
    outputs = [tmp_path / f"tet{suffix}" for suffix in (".msh", ".xdmf", ".npz", ".stl")]
    done = run("export", folder / "good.vtu", *outputs, "--msh-version", "4.1")
    assert done.returncode == 0, done.stderr
    assert outputs[0].read_bytes().startswith(b"$MeshFormat\n4.1 ")
    done = run("certify", *outputs[:3])
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(": valid; 1 tets") == 3


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("absent.vtu", "absent.vtu: no such file"),
        ("broken.vtu", "broken.vtu: cannot be read as a mesh"),
        ("broken.npz", "broken.npz: not an archive of vertices and tets"),
        ("surface.vtk", "surface.vtk: no tets in it"),
        ("bricks.vtk", "bricks.vtk: holds hexahedron cells; only linear tets can be used"),
        ("infinite.mesh", "infinite.mesh: a coordinate is not finite"),
        ("empty", "empty: no tet meshes"),
    ],
)
def test_unusable_input_is_one_line_and_status_2(tmp_path, monkeypatch, capsys, name, told):
    path = tmp_path / name
    if name.startswith("broken"):
        path.write_text("<VTKFile>")
    if name == "surface.vtk":
        meshio.write(path, meshio.Mesh(CORNER, [("triangle", TET[:, :3])]))
    if name == "bricks.vtk":
        meshio.write(path, meshio.Mesh(np.zeros((8, 3)), [("hexahedron", np.arange(8)[None])]))
    if name == "infinite.mesh":
        meshio.write(path, meshio.Mesh(CORNER * np.array([np.nan, 1, 1]), [("tetra", TET)]))
    if name == "empty":
        path.mkdir()
    assert error_of(monkeypatch, capsys, "certify", path) == f"error: {tmp_path}/{told}"


def error_of(monkeypatch, capsys, *arguments):
    """The one line on stderr, up to the first parenthesis after the message."""
    from tetgan.cli import main

    monkeypatch.setattr(sys, "argv", ["tetgan", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    out, error = capsys.readouterr()
    assert out == ""
    (line,) = error.splitlines()
    return line.split(" (")[0]


def test_meshes_of_several_folders_keep_their_places_and_a_broken_one_is_listed(folder, tmp_path):
    again = tmp_path / "others" / "good.vtu"
    again.parent.mkdir()
    again.write_bytes((folder / "good.vtu").read_bytes())
    (again.parent / "broken.npz").write_text("nothing")
    done = run("certify", folder, again.parent, again, "--out", tmp_path / "out")
    assert done.returncode == 1, done.stderr
    assert f"{again.parent}/broken.npz: not usable: not an archive of vertices and tets" in done.stdout
    assert done.stdout.splitlines()[-1] == "2 of 4 meshes are valid"
    table = pd.read_csv(tmp_path / "out" / "certificate.csv")
    names = ["meshes/good.vtu", "meshes/more/bad.msh", "others/broken.npz", "others/good.vtu"]
    assert (list(table["mesh"]), list(table["valid"])) == (names, [True, False, False, True])
    assert table["reasons"][2].startswith("not an archive")
    assert not json.loads((tmp_path / "out" / "others" / "broken.npz.json").read_text())["valid"]


def test_an_unknown_version_is_one_line(folder, tmp_path, monkeypatch, capsys):
    line = error_of(
        monkeypatch, capsys, "export", folder / "good.vtu", tmp_path / "a.msh", "--msh-version", "3"
    )
    assert line == f"error: {tmp_path}/a.msh: no version '3' of Gmsh's format; use 2.2 or 4.1"


def test_an_unknown_format_is_one_line(folder, tmp_path, monkeypatch, capsys):
    line = error_of(monkeypatch, capsys, "export", folder / "good.vtu", tmp_path / "a.blend")
    assert line == f"error: {tmp_path}/a.blend: no mesh format '.blend' to write; use '.msh' or '.vtu'"
