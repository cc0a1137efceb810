"""Every format read back by another program than the one that wrote it."""

import importlib
import json
import struct

import igl
import numpy as np
import pytest
import trimesh

from tetgan.errors import UserError
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.solids import usd
from tetgan.solids.export import SOLIDS, SURFACES, write_mesh, write_surface, write_tets
from tetgan.solids.reading import read_solid


@pytest.fixture(scope="module")
def mesh(grid, operator, make_field):
    """A mesh of the paper's, with inverted tets in it: they must not be turned either."""
    options = MeshingOptions(mode="paper")
    return build_solid(make_field(1, 0.98), grid, operator, 1.0, options, smoothing=False)


def by_our_reader(path):
    """As `tetgan certify` reads it: by meshio, or by usd-core."""
    found = read_solid(path)
    return found.vertices, found.tets


VTK_READERS = {
    ".vtu": ("vtkIOXML", "vtkXMLUnstructuredGridReader"),
    ".vtk": ("vtkIOLegacy", "vtkUnstructuredGridReader"),
    ".xdmf": ("vtkIOXdmf2", "vtkXdmfReader"),
}


def by_vtk(path):
    """VTK's own readers, which ParaView uses too."""
    pytest.importorskip("vtkmodules", reason="vtk comes with the extra 'dev'")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import VTK_TETRA

    module, name = VTK_READERS[path.suffix]
    reader = getattr(importlib.import_module(f"vtkmodules.{module}"), name)()
    reader.SetFileName(str(path))
    reader.Update()
    found = reader.GetOutputDataObject(0)
    assert {found.GetCellType(cell) for cell in range(found.GetNumberOfCells())} == {VTK_TETRA}
    corners = vtk_to_numpy(found.GetCells().GetConnectivityArray())
    return vtk_to_numpy(found.GetPoints().GetData()), corners.reshape(-1, 4)


def by_gmsh(path):
    gmsh = pytest.importorskip("gmsh", reason="gmsh is no dependency")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        tags, points, _ = gmsh.model.mesh.getNodes()
        (kind,), _, (corners,) = gmsh.model.mesh.getElements(3)
        assert kind == 4  # linear tets
        assert (tags == np.arange(len(tags)) + 1).all()
        return points.reshape(-1, 3).copy(), corners.reshape(-1, 4).astype(np.int64) - 1
    finally:
        gmsh.finalize()


def by_libigl_msh(path):
    points, _, tets, *_ = igl.readMSH(path)
    return points, tets


def by_libigl_mesh(path):
    points, tets, _ = igl.readMESH(path)
    return points, tets


def by_abaqus_rules(path):
    """Keyword lines begin with a star; below them are numbers, first that of the node or element."""
    parts, keyword = {}, ""
    for line in path.read_text().splitlines():
        if line.startswith("*"):
            keyword = line.upper().replace(" ", "")
        elif keyword.startswith(("*NODE", "*ELEMENT")):
            parts.setdefault(keyword, []).append([float(word) for word in line.split(",")])
    (nodes,), (elements,) = (
        [np.array(rows) for key, rows in parts.items() if key.startswith(name)]
        for name in ("*NODE", "*ELEMENT,TYPE=C3D4")
    )
    assert (nodes[:, 0] == np.arange(len(nodes)) + 1).all()
    return nodes[:, 1:], elements[:, 1:].astype(np.int64) - 1


def by_numpy(path):
    with np.load(path) as arrays:
        return arrays["vertices"], arrays["tets"]


READERS = [
    *((suffix, "2.2", by_our_reader) for suffix in SOLIDS),
    *((suffix, "2.2", by_vtk) for suffix in VTK_READERS),
    *((".msh", version, by_gmsh) for version in ("2.2", "4.1")),
    (".mesh", "2.2", by_gmsh),
    (".msh", "4.1", by_our_reader),
    (".msh", "2.2", by_libigl_msh),
    (".mesh", "2.2", by_libigl_mesh),
    (".inp", "2.2", by_abaqus_rules),
    (".npz", "2.2", by_numpy),
]


@pytest.mark.parametrize(
    ("suffix", "version", "read"), READERS, ids=lambda value: getattr(value, "__name__", value)
)
def test_others_read_the_same_solid(tmp_path, mesh, suffix, version, read):
    if suffix in usd.SUFFIXES:
        pytest.importorskip("pxr.UsdGeom", reason="usd-core comes with the extra 'usd'")
    path = tmp_path / f"a{suffix}"
    write_mesh(path, mesh, msh_version=version)
    vertices, tets = read(path)
    # Numbers in .inp have 13 digits, those in USD single precision.
    digits = {".inp": 1e-12, **dict.fromkeys(usd.SUFFIXES, 1e-7)}
    np.testing.assert_allclose(vertices, mesh.vertices, rtol=digits.get(suffix, 0.0))
    # Corner by corner, so no tet is turned.
    np.testing.assert_array_equal(tets, mesh.tets)
    assert [found.name for found in tmp_path.iterdir()] == [path.name]


def surface_by_libigl(path):
    vertices, faces = igl.read_triangle_mesh(path)
    return vertices[faces]


def surface_by_trimesh(path):
    return trimesh.load(path, force="mesh", process=False).triangles


def surface_by_gltf_rules(path):
    """The arrays of a binary glTF, by its specification: JSON, then one buffer."""
    content = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    size, _ = struct.unpack_from("<I4s", content, 12)
    head, buffer = json.loads(content[20 : 20 + size]), content[28 + size :]
    (primitive,) = head["meshes"][0]["primitives"]
    kinds = {5126: "<f4", 5125: "<u4", 5123: "<u2"}

    def array(number):
        accessor = head["accessors"][number]
        view = head["bufferViews"][accessor["bufferView"]]
        count = accessor["count"] * {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(buffer, kinds[accessor["componentType"]], count, start)

    positions = array(primitive["attributes"]["POSITION"]).reshape(-1, 3)
    return positions[array(primitive["indices"]).reshape(-1, 3)].astype(np.float64)


SURFACE_READERS = [
    *((suffix, surface_by_trimesh) for suffix in SURFACES),
    *((suffix, surface_by_libigl) for suffix in (".ply", ".obj", ".stl", ".off")),
    (".glb", surface_by_gltf_rules),
]


@pytest.mark.parametrize(
    ("suffix", "read"), SURFACE_READERS, ids=lambda value: getattr(value, "__name__", value)
)
def test_others_read_the_same_surface(tmp_path, mesh, suffix, read):
    write_mesh(tmp_path / f"a{suffix}", mesh)
    # Corner by corner, since .stl has no shared vertices; single precision holds 6e-8.
    np.testing.assert_allclose(read(tmp_path / f"a{suffix}"), mesh.vertices[mesh.faces], atol=1e-7)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off"])
def test_a_surface_has_no_vertices_of_the_inside(tmp_path, mesh, suffix):
    write_surface(tmp_path / f"a{suffix}", mesh)
    read = trimesh.load(tmp_path / f"a{suffix}", force="mesh", process=False)
    assert len(read.vertices) == len(np.unique(mesh.faces)) < len(mesh.vertices)


def test_capitals_in_a_suffix_are_the_same_surface(tmp_path, mesh):
    write_mesh(tmp_path / "small.stl", mesh)
    write_mesh(tmp_path / "CAPITAL.STL", mesh)
    assert (tmp_path / "CAPITAL.STL").read_bytes() == (tmp_path / "small.stl").read_bytes()


def test_msh_is_gmshs(tmp_path, mesh, capfd):
    for version in ("2.2", "4.1"):
        write_tets(tmp_path / "a.msh", mesh, msh_version=version)
        assert (tmp_path / "a.msh").read_bytes().startswith(f"$MeshFormat\n{version} 1 8\n".encode())
    assert capfd.readouterr() == ("", "")  # meshio warns about missing groups


@pytest.mark.parametrize("write", [write_surface, write_tets])
def test_an_unknown_suffix_is_one_line_and_no_file(tmp_path, mesh, write):
    with pytest.raises(UserError, match=r"a\.blend: no mesh format '\.blend' to write; use "):
        write(tmp_path / "a.blend", mesh)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a.ply", "a.vtu", "a.msh", "a.xdmf", "a.npz"])
def test_the_same_mesh_gives_the_same_bytes(tmp_path, mesh, name):
    write_mesh(tmp_path / name, mesh)
    first = (tmp_path / name).read_bytes()
    write_mesh(tmp_path / name, mesh)
    assert (tmp_path / name).read_bytes() == first
