"""CalculiX on the files that we write for it, beside our own elasticity."""

import shutil
import subprocess

import numpy as np
import pytest

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.triangles import area_normals
from tetgan.mechanics.materials import Material, section_of
from tetgan.mechanics.options import LoadCase
from tetgan.mechanics.simulation import simulate
from tetgan.solids.elements import linear_elements, quadratic_elements, scaled
from tetgan.solids.export import write_tets
from tetgan.solids.groups import choose_groups
from tetgan.solids.solid import SolidMesh
from tetgan.solids.units import UNITS

pytestmark = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed: apt-get install calculix-ccx"
)

STUFF = Material(young=1e9, poisson=0.3, density=1000)
SIDE = 0.1

STEP = """
*INCLUDE, INPUT=mesh.inp
*STEP
*STATIC
*BOUNDARY
floor, 1, 3
{loads}
*NODE PRINT, NSET=nodes
U
*END STEP
"""


@pytest.fixture
def post(bar):
    """A post of 0.1 by 1 by 0.1 m, upright."""
    body = bar(10, 2)
    tets = body.tets[:, [0, 2, 1, 3]]
    return SolidMesh(body.vertices[:, [1, 0, 2]], tets, boundary_faces(tets))


@pytest.fixture
def calculix(tmp_path):
    """Writes a deck around a mesh, runs it, and reads the displacement of each node."""

    def run(elements, unit, loads):
        system = UNITS[unit]
        file = scaled(elements, 1 / system.length)
        write_tets(tmp_path / "mesh.inp", file, system=system, section=section_of("stuff", STUFF, system))
        (tmp_path / "deck.inp").write_text(STEP.format(loads="\n".join(loads)))
        done = subprocess.run(
            ["ccx", "deck"], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False
        )
        assert done.returncode == 0 and "ERROR" not in done.stdout, done.stdout
        lines = (line.split() for line in (tmp_path / "deck.dat").read_text().splitlines())
        rows = np.array([list(map(float, words)) for words in lines if len(words) == 4])
        assert (rows[:, 0] == np.arange(len(elements.nodes)) + 1).all()
        return rows[:, 1:] * system.length

    return run


def even_forces(elements, group, force):
    """Forces at the nodes of an even traction on flat faces: a third to each corner, or to each middle."""
    faces = elements.faces[elements.groups[group]]
    areas = np.linalg.norm(area_normals(elements.nodes[faces[:, :3]]), axis=1)
    forces = np.zeros((len(elements.nodes), 3))
    np.add.at(forces, faces[:, -3:], (areas / areas.sum() / 3)[:, None, None] * np.array(force))
    return forces


@pytest.mark.parametrize(("order", "unit"), [(1, "m"), (2, "m"), (2, "mm"), (2, "in")])
def test_a_cantilever_bends_as_ours_does(post, calculix, order, unit):
    make = linear_elements if order == 1 else quadratic_elements
    elements = make(post, choose_groups(post, {}))
    forces = even_forces(elements, "top", (10.0, 0.0, 0.0)) / UNITS[unit].force
    loads = [f"{node + 1}, 1, {forces[node, 0]:.9e}" for node in np.flatnonzero(forces[:, 0])]
    found = calculix(elements, unit, ["*CLOAD", *loads])
    ours = simulate(post, LoadCase(material=STUFF, load=["top=10,0,0N"], order=order)).displacement
    peak = np.abs(ours).max()
    # The same elements, integrated exactly: what differs is the six digits that CalculiX prints.
    np.testing.assert_allclose(found[: len(ours)], ours, atol=1e-5 * peak)


def test_a_pressure_acts_on_the_named_surface(post, calculix):
    elements = quadratic_elements(post, choose_groups(post, {"side": "x=0.1"}))
    found = calculix(elements, "mm", ["*DSLOAD", "side, P, 0.001"])  # MPa, into the body
    case = LoadCase(material=STUFF, load=[f"x=0.1={-1e3 * SIDE},0,0N"])  # the same 1 kPa on 0.1 m^2
    ours = simulate(post, case).displacement
    np.testing.assert_allclose(found[: len(ours)], ours, atol=1e-5 * np.abs(ours).max())


def test_weight_needs_the_density_of_the_file(post, calculix):
    elements = quadratic_elements(post, choose_groups(post, {}))
    found = calculix(elements, "mm", ["*DLOAD", "solid, GRAV, 9810., 0., -1., 0."])
    ours = simulate(post, LoadCase(material=STUFF, load=["top=0N"], gravity=True)).displacement
    np.testing.assert_allclose(found[: len(ours)], ours, atol=1e-5 * np.abs(ours).max())
