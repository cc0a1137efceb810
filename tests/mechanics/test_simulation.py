"""Whole simulations: what comes out, what is written, and what is refused."""

import re
from dataclasses import replace

import meshio
import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from tetgan.cli import app
from tetgan.errors import UserError
from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.tets import TetMesh
from tetgan.mechanics.errors import UnfitError
from tetgan.mechanics.materials import Material
from tetgan.mechanics.options import LoadCase
from tetgan.mechanics.pieces import largest_piece
from tetgan.mechanics.simulation import simulate, write_simulation
from tetgan.solids.export import write_tets
from tetgan.solids.reading import read_solid
from tetgan.solids.solid import SolidMesh


def beside(one: TetMesh, other: TetMesh, by: float) -> TetMesh:
    """Both bodies, the other moved along x."""
    vertices = np.concatenate([one.vertices, other.vertices + np.array([by, 0, 0])])
    return TetMesh(vertices, np.concatenate([one.tets, other.tets + len(one.vertices)]))


@pytest.fixture(scope="module")
def result(crooked):
    return simulate(crooked, LoadCase())


def test_twice_the_load_twice_the_displacement_four_times_the_work(crooked, result):
    double = simulate(crooked, LoadCase(load=["top=1kN"]))
    peak = np.abs(result.displacement).max()
    np.testing.assert_allclose(double.displacement, 2 * result.displacement, atol=1e-10 * peak)
    np.testing.assert_allclose(double.stress, 2 * result.stress, rtol=1e-6)
    assert double.work == pytest.approx(4 * result.work)


def test_twice_the_size_half_the_displacement_a_quarter_of_the_stress(crooked, result):
    large = simulate(crooked, LoadCase(size=2.0))
    peak = np.abs(result.displacement).max()
    np.testing.assert_allclose(large.displacement, result.displacement / 2, atol=1e-10 * peak)
    np.testing.assert_allclose(large.stress, result.stress / 4, rtol=1e-6)
    assert large.mass == pytest.approx(8 * result.mass)


def test_held_nodes_stay_and_the_rest_sinks(result):
    on_floor = np.isclose(result.vertices[:, 1], 0)
    assert not result.displacement[on_floor].any()
    assert (result.displacement[~on_floor, 1] < 0).all()
    assert result.load == pytest.approx([0, -500, 0], abs=1e-9)
    assert result.record()["imbalance"] < 1e-9
    # Nearly a bar under 500 Pa: a cube whose sides are free but for its foot.
    assert result.stress.mean() == pytest.approx(500, rel=0.1)


def test_cut_tets_are_the_same_body_and_a_little_softer(crooked, result):
    finer = simulate(crooked, LoadCase(order=1, refine=1))
    coarse = simulate(crooked, LoadCase(order=1))
    assert len(finer.tets) == 8 * len(coarse.tets) and finer.mass == pytest.approx(coarse.mass)
    assert np.array_equal(finer.vertices[: len(coarse.vertices)], coarse.vertices)
    # Displacement elements are too stiff, and less so the more freedom they have.
    assert coarse.work < finer.work < result.work * 1.05


def test_cut_tets_are_held_where_the_uncut_are(bar):
    # A foot cut off at a slant: of its quartered faces the lowest lie lower than the whole ones' middles.
    block = bar(3, 3, length=0.3, side=1.0)
    vertices = block.vertices.copy()
    vertices[:, 1] += np.where(vertices[:, 1] < 0.1, 0.25 * vertices[:, 2], 0.0)
    slanted = TetMesh(vertices, block.tets)
    coarse, finer = (simulate(slanted, LoadCase(reach=0.1, refine=times)) for times in (0, 1))
    assert set(map(tuple, coarse.feet.round(9))) <= set(map(tuple, finer.feet.round(9)))
    assert finer.work == pytest.approx(coarse.work, rel=0.1)
    same = simulate(slanted, LoadCase(reach=0.1), surface=TetMesh(vertices.copy(), block.tets))
    np.testing.assert_allclose(same.displacement, coarse.displacement, rtol=1e-9, atol=1e-15)


def test_an_inverted_tet_is_refused(crooked):
    vertices = crooked.vertices.copy()
    vertices[np.argmin(((vertices - 0.5) ** 2).sum(axis=1))] += 0.6
    with pytest.raises(UnfitError, match="tets are inverted or flat; 'tetgan certify'") as caught:
        simulate(TetMesh(vertices, crooked.tets), LoadCase())
    assert caught.value.kind == "inverted tets"


def test_a_floating_piece_is_refused_and_can_be_left_out(crooked, bar):
    crumb = bar(1, 1, length=0.1)
    raised = replace(crumb, vertices=crumb.vertices + np.array([0, 0.5, 0]))
    both = beside(crooked, raised, by=2.0)
    with pytest.raises(UnfitError, match=r"1 of 2 pieces \(6 of 390 tets\) are not held by 'floor'"):
        simulate(both, LoadCase())
    alone = largest_piece(both)
    assert np.array_equal(alone.vertices, crooked.vertices)
    assert len(alone.tets) == len(crooked.tets)


def test_two_bodies_that_both_stand_are_simulated_together(crooked):
    found = simulate(beside(crooked, crooked, by=2.0), LoadCase(order=1))
    half = len(crooked.vertices)
    np.testing.assert_allclose(found.displacement[:half], found.displacement[half:], atol=1e-15)


def test_pieces_that_touch_in_an_edge_alone_are_two(bar):
    """A hinge would let one of them swing freely."""
    cube = bar(1, 1, length=1.0, side=1.0)
    vertices = np.concatenate([cube.vertices, cube.vertices + np.array([1.0, 1.0, 0])])
    places, merged = np.unique(vertices, axis=0, return_inverse=True)
    tets = np.concatenate([cube.tets, cube.tets + len(cube.vertices)])
    with pytest.raises(UnfitError, match="1 of 2 pieces"):
        simulate(TetMesh(places, merged.reshape(-1)[tets]), LoadCase())


def test_the_largest_piece_comes_with_the_share_left_out(crooked, bar, tmp_path):
    crumb = bar(1, 1, length=0.5, side=0.5)  # an eighth of the cube's volume, a ninth of both
    both = beside(crooked, crumb, by=2.0)
    write_tets(tmp_path / "both.vtu", SolidMesh(both.vertices, both.tets, boundary_faces(both.tets)))
    arguments = ["simulate", str(tmp_path / "both.vtu"), "--order", "1"]
    whole = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert re.search(r"left out +│ nothing", whole.output)
    figure = ["--largest", "--figure", str(tmp_path / "piece.png")]
    piece = CliRunner().invoke(app, [*arguments, *figure], catch_exceptions=False)
    assert re.search(r"left out +│ 11\.111% of the volume", piece.output)
    record = pd.read_csv(tmp_path / "piece.csv").iloc[0]
    assert record["left_out"] == pytest.approx(1 / 9) and record["tets"] == len(crooked.tets)


@pytest.mark.parametrize(("fix", "ways"), [(["floor/y"], 3), (["floor/x"], 4), (["left/x", "floor/y"], 1)])
def test_a_body_that_may_slide_is_refused(crooked, fix, ways):
    with pytest.raises(UnfitError, match=f"free to move in {ways} of 6 ways"):
        simulate(crooked, LoadCase(fix=fix))


def test_no_force_is_refused(crooked):
    with pytest.raises(UserError, match="no force"):
        simulate(crooked, LoadCase(load=["top=0N"]))


def test_a_material_near_incompressible_is_an_error():
    with pytest.raises(UserError, match="poisson"):
        Material.parse({"young": 1.0, "poisson": 0.5, "density": 1.0}, "--material")


def test_the_file_holds_what_was_found(result, tmp_path):
    write_simulation(tmp_path / "bent.vtu", result)
    mesh = meshio.read(tmp_path / "bent.vtu")
    assert np.array_equal(mesh.cells_dict["tetra"], result.tets)
    assert np.array_equal(mesh.point_data["displacement"], result.displacement)
    assert np.array_equal(mesh.cell_data["von_mises"][0], result.stress)
    assert len(mesh.point_data["von_mises"]) == len(mesh.points)
    with pytest.raises(UserError, match=r"bent\.stl: .* written as \.vtu or \.vtk"):  # which holds no tets
        write_simulation(tmp_path / "bent.stl", result)


def test_the_command_writes_a_mesh_a_picture_and_a_table(bar, tmp_path):
    body = bar(3, 1, length=0.3)
    upright = SolidMesh(body.vertices[:, [1, 0, 2]], body.tets[:, [0, 2, 1, 3]], boundary_faces(body.tets))
    write_tets(tmp_path / "post.vtu", upright)
    arguments = ["simulate", str(tmp_path / "post.vtu"), "--load", "top=10,0,0N", "--order", "1"]
    outputs = ["--out", str(tmp_path / "out.vtu"), "--figure", str(tmp_path / "out.png")]
    steel = ["--material", "{young: 2.1e11, poisson: 0.3, density: 7850}"]
    told = CliRunner().invoke(app, [*arguments, *outputs, *steel], catch_exceptions=False)
    assert told.exit_code == 0 and "largest displacement" in told.output
    assert "23.55 kg" in told.output  # 7850 times 0.3 times 0.1 squared
    assert read_solid(tmp_path / "out.vtu").tets.shape == body.tets.shape
    assert (tmp_path / "out.png").stat().st_size > 10_000 and (tmp_path / "out.csv").is_file()


@pytest.mark.parametrize(
    ("extra", "words"),
    [
        (["--material", "cheese"], "no preset 'cheese'"),
        (["--load", "top=heavy"], "load: 'top=heavy'"),
        (["--size", "0"], "size"),
        (["--order", "3"], "order"),
        (["--out", "bent.stl"], r"bent\.stl: .* written as \.vtu"),
        (["--figure", "bent.xyz"], r"bent\.xyz: a figure is written as \.png"),
        (["--fix", "flor"], r"^\S+bar\.vtu: region 'flor'"),
    ],
)
def test_a_mistake_is_named(bar, tmp_path, extra, words):
    body = bar(1, 1)
    write_tets(tmp_path / "bar.vtu", SolidMesh(body.vertices, body.tets, boundary_faces(body.tets)))
    with pytest.raises(UserError, match=words):
        CliRunner().invoke(app, ["simulate", str(tmp_path / "bar.vtu"), *extra], catch_exceptions=False)
