"""Files that trimesh and meshio read back."""

import meshio
import numpy as np
import pytest
import trimesh

from tetgan.errors import UserError
from tetgan.grids.grid import tet_volumes
from tetgan.meshing.build import build_solid
from tetgan.meshing.export import write_surface, write_tets
from tetgan.meshing.options import MeshingOptions


@pytest.fixture(scope="module")
def mesh(grid, operator, make_field):
    return build_solid(make_field(1, 0.98), grid, operator, 1.0, MeshingOptions(), smoothing=False)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".stl", ".off", ".glb"])
def test_surfaces_load_in_trimesh(tmp_path, mesh, suffix):
    write_surface(tmp_path / f"a{suffix}", mesh)
    read = trimesh.load(tmp_path / f"a{suffix}", force="mesh", process=False)
    # Corner by corner, since .stl has no shared vertices; single precision holds 6e-8.
    np.testing.assert_allclose(read.triangles, mesh.vertices[mesh.faces], atol=1e-7)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off"])
def test_a_surface_has_no_vertices_of_the_inside(tmp_path, mesh, suffix):
    write_surface(tmp_path / f"a{suffix}", mesh)
    read = trimesh.load(tmp_path / f"a{suffix}", force="mesh", process=False)
    assert len(read.vertices) == len(np.unique(mesh.faces)) < len(mesh.vertices)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".stl"])
def test_surfaces_load_in_meshio(tmp_path, mesh, suffix):
    write_surface(tmp_path / f"a{suffix}", mesh)
    read = meshio.read(tmp_path / f"a{suffix}")
    corners = read.points[read.cells_dict["triangle"]]
    np.testing.assert_allclose(corners, mesh.vertices[mesh.faces], atol=1e-7)


@pytest.mark.parametrize("suffix", [".msh", ".vtu", ".vtk", ".mesh", ".inp"])
def test_solids_load_in_meshio(tmp_path, mesh, suffix):
    write_tets(tmp_path / f"a{suffix}", mesh)
    read = meshio.read(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(read.points, mesh.vertices)
    np.testing.assert_array_equal(read.cells_dict["tetra"], mesh.tets)
    volume = tet_volumes(read.points, read.cells_dict["tetra"].astype(np.int64)).sum()
    assert volume == pytest.approx(tet_volumes(mesh.vertices, mesh.tets).sum())


def test_msh_is_gmshs(tmp_path, mesh, capfd):
    write_tets(tmp_path / "a.msh", mesh)
    assert (tmp_path / "a.msh").read_bytes().startswith(b"$MeshFormat\n2.2 1 8\n")
    assert capfd.readouterr() == ("", "")  # meshio warns about missing groups


@pytest.mark.parametrize("write", [write_surface, write_tets])
def test_an_unknown_suffix_is_one_line_and_no_file(tmp_path, mesh, write):
    with pytest.raises(UserError, match=r"a\.blend: no mesh format '\.blend' to write; use "):
        write(tmp_path / "a.blend", mesh)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("write", "name"), [(write_surface, "a.ply"), (write_tets, "a.vtu"), (write_tets, "a.msh")]
)
def test_the_same_mesh_gives_the_same_bytes(tmp_path, mesh, write, name):
    write(tmp_path / name, mesh)
    first = (tmp_path / name).read_bytes()
    write(tmp_path / name, mesh)
    assert (tmp_path / name).read_bytes() == first
