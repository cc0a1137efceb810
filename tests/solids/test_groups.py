"""Named regions as other programs read them, in every format that has such a thing."""

import meshio
import numpy as np
import pytest
import skfem

from tetgan.errors import UserError
from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.tets import orientations
from tetgan.solids.abaqus import Section
from tetgan.solids.elements import MIDDLES, linear_elements, quadratic_elements
from tetgan.solids.export import write_mesh, write_tets
from tetgan.solids.groups import choose_groups, parse_groups
from tetgan.solids.reading import read_solid
from tetgan.solids.regions import find_faces
from tetgan.solids.solid import SolidMesh
from tetgan.solids.units import UNITS

NAMED = {"seat": "0,0,0:1,1,0.5", "wall": "x=0", "upper": "y>0.5"}


@pytest.fixture(scope="module")
def cube():
    """The unit cube in 4 x 4 x 4 cubes of six tets each."""
    ticks = np.linspace(0, 1, 5)
    mesh = skfem.MeshTet.init_tensor(ticks, ticks, ticks)
    vertices, tets = np.ascontiguousarray(mesh.p.T), mesh.t.T.astype(np.int64)
    turned = orientations(vertices, tets) < 0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    return SolidMesh(vertices, tets, boundary_faces(tets))


@pytest.fixture(scope="module", params=[1, 2], ids=["linear", "quadratic"])
def elements(request, cube):
    groups = choose_groups(cube, NAMED)
    return (linear_elements if request.param == 1 else quadratic_elements)(cube, groups)


def expected_nodes(elements, name):
    """By their places alone: a face of the cube has two triangles a square."""
    x, y, z = elements.nodes.T
    outside = ((elements.nodes == 0) | (elements.nodes == 1)).any(axis=1)
    return np.flatnonzero(
        {
            "floor": y == 0,
            "top": y == 1,
            "surface": outside,
            "seat": outside & (z <= 0.5),
            "wall": x == 0,
            "upper": outside & (y >= 0.5),
        }[name]
    )


FACES = {"floor": 32, "top": 32, "surface": 192, "seat": 32 + 4 * 16, "wall": 32, "upper": 32 + 4 * 16}


def test_a_group_has_the_faces_and_nodes_of_its_region(elements):
    assert list(elements.groups) == list(FACES)
    for name, count in FACES.items():
        assert elements.groups[name].sum() == count
        assert np.array_equal(elements.nodes_of(name), expected_nodes(elements, name))


def test_middles_lie_between_the_corners_they_belong_to(elements):
    middles = elements.nodes[elements.cells[:, 4:]]
    ends = elements.nodes[elements.cells[:, MIDDLES]]
    if elements.order == 2:
        np.testing.assert_array_equal(middles, ends.mean(axis=2))
        corners, between = elements.nodes[elements.faces[:, :3]], elements.nodes[elements.faces[:, 3:]]
        np.testing.assert_array_equal(between, (corners + np.roll(corners, -1, axis=1)) / 2)
    assert elements.order == 1 + bool(middles.size)


@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_gmsh_knows_the_groups(tmp_path, elements, version):
    gmsh = pytest.importorskip("gmsh", reason="gmsh is no dependency")
    write_tets(tmp_path / "a.msh", elements, msh_version=version)
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "a.msh"))
        names = {}
        for dimension, tag in gmsh.model.getPhysicalGroups():
            name = gmsh.model.getPhysicalName(dimension, tag)
            entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
            parts = [gmsh.model.mesh.getElements(dimension, entity) for entity in entities]
            names[name] = dimension, sum(len(tags) for _, (tags,), _ in parts)
            nodes, _ = gmsh.model.mesh.getNodesForPhysicalGroup(dimension, tag)
            if dimension == 2:
                assert np.array_equal(np.sort(nodes) - 1, elements.nodes_of(name))
        assert names == {**{name: (2, count) for name, count in FACES.items()}, "solid": (3, 384)}
        _, (tets,), (corners,) = gmsh.model.mesh.getElements(3)
        qualities = gmsh.model.mesh.getElementQualities(tets, "minDetJac")
        assert qualities == pytest.approx(np.full(384, 1 / 64))  # straight edges: 6 times the volume
        assert corners.reshape(384, -1)[:, :4].tolist() == (elements.tets + 1).tolist()
    finally:
        gmsh.finalize()


@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_meshio_knows_the_physical_groups(tmp_path, elements, version):
    write_tets(tmp_path / "a.msh", elements, msh_version=version)
    mesh = meshio.read(tmp_path / "a.msh")
    assert mesh.field_data["floor"].tolist() == [1, 2] and mesh.field_data["solid"].tolist() == [7, 3]
    name = "tetra" if elements.order == 1 else "tetra10"
    assert np.array_equal(mesh.cells_dict[name], elements.cells)


def test_abaqus_sets_are_the_groups(tmp_path, elements):
    write_tets(tmp_path / "a.inp", elements, section=Section("steel", 210e9, 0.3, 7850.0))
    mesh = meshio.read(tmp_path / "a.inp")
    assert np.array_equal(mesh.cells_dict["tetra" if elements.order == 1 else "tetra10"], elements.cells)
    for name in FACES:
        assert np.array_equal(mesh.point_sets[name], elements.nodes_of(name))
        (found,) = mesh.cell_sets[f"{name}_elements"]
        assert np.array_equal(found, elements.cells_of(name))
    text = (tmp_path / "a.inp").read_text()
    assert text.endswith(
        "*MATERIAL, NAME=steel\n*ELASTIC\n2.100000000e+11, 0.3\n*DENSITY\n7.850000000e+03\n"
        "*SOLID SECTION, ELSET=solid, MATERIAL=steel\n"
    )
    words = [word for line in text.splitlines() if line[0] not in "*" for word in line.split(",")]
    assert max(len(word.strip()) for word in words) <= 20  # all that CalculiX reads of a number


def test_abaqus_surfaces_name_the_sides_of_elements(tmp_path, elements):
    """S1 = 1-2-3, S2 = 1-4-2, S3 = 2-4-3, S4 = 3-4-1, by the manual of CalculiX."""
    write_tets(tmp_path / "a.inp", elements)
    sides = {"S1": [0, 1, 2], "S2": [0, 3, 1], "S3": [1, 3, 2], "S4": [2, 3, 0]}
    for part in (tmp_path / "a.inp").read_text().split("*SURFACE, NAME=")[1:]:
        head, *lines = part.split("\n*")[0].splitlines()
        found = set()
        for element, side in (line.split(", ") for line in lines):
            found.add(frozenset(elements.cells[int(element) - 1, sides[side]].tolist()))
        chosen = elements.faces[elements.groups[head.partition(",")[0]], :3]
        assert found == set(map(frozenset, chosen.tolist())) and len(found) == len(lines)


@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".xdmf"])
def test_vtk_has_ones_where_the_groups_are(tmp_path, elements, suffix):
    write_tets(tmp_path / f"a{suffix}", elements)
    mesh = meshio.read(tmp_path / f"a{suffix}")
    assert np.array_equal(mesh.points, elements.nodes)
    assert np.array_equal(mesh.cells_dict["tetra" if elements.order == 1 else "tetra10"], elements.cells)
    for name in FACES:
        assert np.array_equal(np.flatnonzero(mesh.point_data[name]), elements.nodes_of(name))
        assert np.array_equal(np.flatnonzero(mesh.cell_data[name][0]), elements.cells_of(name))


@pytest.mark.parametrize("suffix", [".msh", ".inp", ".vtu", ".vtk", ".xdmf"])
def test_linear_files_with_groups_are_read_again(tmp_path, cube, suffix):
    write_mesh(tmp_path / f"a{suffix}", linear_elements(cube, choose_groups(cube, NAMED)))
    found = read_solid(tmp_path / f"a{suffix}")
    assert np.array_equal(found.tets, cube.tets) and np.array_equal(found.vertices, cube.vertices)


@pytest.mark.parametrize("suffix", [".mesh", ".npz"])
def test_degree_2_is_refused_where_a_format_has_none(tmp_path, cube, suffix):
    with pytest.raises(UserError, match=f"a{suffix}: '{suffix}' has no elements of degree 2; use .msh"):
        write_mesh(tmp_path / f"a{suffix}", quadratic_elements(cube))
    assert list(tmp_path.iterdir()) == []


def test_a_surface_of_degree_2_has_the_corners_alone(tmp_path, cube):
    write_mesh(tmp_path / "a.ply", quadratic_elements(cube))
    write_mesh(tmp_path / "b.ply", linear_elements(cube))
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_groups_read_as_they_are_written(cube):
    assert parse_groups(["seat=y=0.4", "arm=0,0,0:1,1,1", "low=floor"]) == {
        "seat": "y=0.4",
        "arm": "0,0,0:1,1,1",
        "low": "floor",
    }
    groups = choose_groups(cube, {"Floor": "y<0.5"})
    assert list(groups) == ["top", "surface", "Floor"]  # ours gives way


@pytest.mark.parametrize(
    ("texts", "told"),
    [
        (["seat"], "'seat' is not of the form name=region"),
        (["seat="], "'seat=' is not of the form name=region"),
        (["2nd=floor"], "'2nd' is no name"),
        (["a b=floor"], "'a b' is no name"),
        (["solid=floor"], "the name 'solid' is taken"),
        (["one=floor", "One=top"], "the name 'One' is taken"),
        (["my_elements=floor"], "'my_elements' ends with '_elements'"),
        (["seat=nowhere"], "region 'nowhere' is none of surface, left, .* nor a plane 'y=0'"),
        (["seat=y=0.3"], "region 'y=0.3' holds no face of the mesh, which spans 0,0,0:1,1,1; move it"),
        (["seat=y<zero"], "region 'y<zero' is none of"),
    ],
)
def test_what_is_no_group_is_named(cube, texts, told):
    with pytest.raises(UserError, match=f"^--group: {told}"):
        choose_groups(cube, parse_groups(texts))


def test_a_default_without_faces_is_left_out_and_told(caplog):
    vertices = np.array([[0, 0, 0], [1, 3, 0], [0, 3, 1], [-1, 3, -1.0]])  # a tet on its tip
    tets = np.array([[0, 1, 2, 3]])
    groups = choose_groups(SolidMesh(vertices, tets, boundary_faces(tets)), {})
    assert list(groups) == ["top", "surface"]
    assert caplog.messages == ["no group 'floor': no face of the mesh looks there"]


def test_units_are_consistent():
    """Steel, as every table of units for solvers has it."""
    expected = {"m": (210e9, 7850), "mm": (210e3, 7.85e-9), "cm": (21e6, 7.85e-5), "in": (30.46e6, 7.345e-4)}
    for unit, (young, density) in expected.items():
        system = UNITS[unit]
        assert (system.stress(210e9), system.density(7850.0)) == pytest.approx((young, density), rel=1e-3)


def test_a_plane_takes_no_face_that_only_touches_it(cube):
    elements = linear_elements(cube, choose_groups(cube, {}))
    from tetgan.solids.groups import _boundary

    faces = _boundary(cube)
    assert find_faces("y = 0", faces).tolist() == elements.groups["floor"].tolist()
    assert find_faces("y<0.1", faces).sum() == 32 + 4 * 4  # of a side's lowest row every second triangle
