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


def test_export_for_a_solver_scales_the_mesh_and_its_material(folder, tmp_path):
    sphere = tmp_path / "sphere.ply"
    sphere.write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    )
    arguments = ["--order", "2", "--onto", sphere, "--units", "mm", "--scale", "0.5", "--material", "steel"]
    outputs = tmp_path / "a.inp", tmp_path / "a.vtu"
    done = run("export", folder / "good.vtu", *outputs, *arguments, "--group", "back=z=0")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("boundary edges: ")
    for path in outputs:
        mesh = meshio.read(path)
        assert mesh.points.max() == 500 and mesh.cells_dict["tetra10"].shape == (1, 10)
    assert mesh.point_data["back"].sum() == 6 and mesh.cell_data["back"][0].tolist() == [1]
    text = outputs[0].read_text()
    assert "** Units: mm, N, tonne, s, MPa" in text
    assert "*ELASTIC\n2.100000000e+05, 0.3\n*DENSITY\n7.850000000e-09\n" in text


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--units", "km"], "export: units: Input should be 'm', 'cm', 'mm' or 'in'"),
        (["--scale", "0"], "export: scale: Input should be greater than 0"),
        (["--order", "3"], "export: order: Input should be 1 or 2"),
        (["--onto", "a.ply"], "--onto: a.ply: only elements of degree 2 have nodes to move; add --order 2"),
        (
            ["--onto", "a.ply", "--order", "2"],
            "--onto: a.ply: no surface there; give a file of triangles, such as .ply",
        ),
        (["--material", "cheese"], "--material: no preset 'cheese'; known are pinewood, steel, rubber, or"),
        (
            ["--material", "{young: -1, poisson: 0.3, density: 1}"],
            "--material: young: Input should be",
        ),
        (["--group", "seat"], "--group: 'seat' is not of the form name=region, such as 'seat=y=0.4'"),
    ],
)
def test_a_mistake_in_an_export_is_one_line(folder, monkeypatch, capsys, arguments, told):
    out = folder / "out"
    line = error_of(monkeypatch, capsys, "export", folder / "good.vtu", out / "a.inp", *arguments)
    assert line.startswith(f"error: {told}")
    assert not out.exists()


def test_a_material_without_inp_is_one_line(folder, tmp_path, monkeypatch, capsys):
    line = error_of(
        monkeypatch, capsys, "export", folder / "good.vtu", tmp_path / "a.msh", "--material", "steel"
    )
    assert line == "error: --material: 'steel' can be written into .inp alone; add such a file"


def test_an_unknown_version_is_one_line(folder, tmp_path, monkeypatch, capsys):
    line = error_of(
        monkeypatch, capsys, "export", folder / "good.vtu", tmp_path / "a.msh", "--msh-version", "3"
    )
    assert line == f"error: {tmp_path}/a.msh: no version '3' of Gmsh's format; use 2.2 or 4.1"


def test_an_unknown_format_is_one_line(folder, tmp_path, monkeypatch, capsys):
    line = error_of(monkeypatch, capsys, "export", folder / "good.vtu", tmp_path / "a.blend")
    assert line == f"error: {tmp_path}/a.blend: no mesh format '.blend' to write; use '.msh' or '.vtu'"
