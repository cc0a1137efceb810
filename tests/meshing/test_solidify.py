"""Any surface to a certified solid, as a function."""

import subprocess
import sys

import numpy as np
import pytest
import trimesh

import tetgan
from tetgan.errors import UserError
from tetgan.geometry.triangles import TriangleMesh
from tetgan.meshing.solidify import Frame, SolidifyOptions, surface_distance
from tetgan.shapes.cleaning import ShapeError
from tetgan.solids.units import parse_length


def box(size, centre=(0, 0, 0)):
    made = trimesh.creation.box(size).apply_translation(centre)
    return np.array(made.vertices), np.array(made.faces)


def both(one, other):
    return np.concatenate([one[0], other[0]]), np.concatenate([one[1], other[1] + len(one[0])])


@pytest.mark.parametrize("interior", ["graded", "fine"])
@pytest.mark.parametrize("centre", [(0, 0, 0), (5000, -300, 20)])
def test_a_box_comes_back_in_its_own_units_and_place(centre, interior):
    solid, certificate, report = tetgan.solidify(box((100, 200, 50), centre), cells=24, interior=interior)
    assert certificate.valid
    assert certificate.min_dihedral >= 15
    assert report.repair == "none"
    assert report.edge == pytest.approx(200 / 24)
    assert report.volume_in == pytest.approx(1e6)
    assert report.volume_out == pytest.approx(1e6, rel=0.02)
    middle, half = np.array(centre), np.array([50, 100, 25])
    np.testing.assert_allclose(solid.vertices.min(axis=0), middle - half, atol=1)
    np.testing.assert_allclose(solid.vertices.max(axis=0), middle + half, atol=1)
    assert report.mean_distance < 0.02 * report.edge
    assert report.hausdorff < report.edge  # corners are cut


def test_a_fine_interior_has_more_tets():
    graded, fine = (tetgan.solidify(box((1, 1, 1)), cells=32, interior=each) for each in ("graded", "fine"))
    assert graded.report.tets < 0.8 * fine.report.tets


def test_an_open_box_is_repaired():
    vertices, faces = box((1, 2, 1))
    found = tetgan.solidify((vertices, faces[2:]), cells=16, alpha=0.1)
    assert found.certificate.valid
    assert found.report.repair == "alpha_wrap"
    assert found.report.volume_out > 0.01
    with pytest.raises(ShapeError, match="not closed"):
        tetgan.solidify((vertices, faces[2:]), cells=16, repair="none")


def test_faces_that_point_inward_make_the_same_solid():
    vertices, faces = box((1, 1, 1))
    one, other = (tetgan.solidify((vertices, each), cells=12) for each in (faces, faces[:, ::-1]))
    assert other.report.repair == "turned"
    np.testing.assert_array_equal(one.solid.tets, other.solid.tets)


def test_a_plate_of_a_third_of_a_cell_is_not_lost():
    found = tetgan.solidify(box((1, 1, 0.02)), cells=16)
    assert found.certificate.valid
    assert found.report.pieces_out == 1
    assert 0.5 < found.report.volume_out / 0.02 < 1.5  # no tet is as thin
    low, high = found.solid.vertices.min(axis=0), found.solid.vertices.max(axis=0)
    assert (high - low)[:2].min() > 0.9


def test_two_bodies_and_a_void():
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.3)
    outer = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    shell = both(
        (np.array(outer.vertices), np.array(outer.faces)),
        (np.array(ball.vertices), np.array(ball.faces)[:, ::-1]),
    )
    found = tetgan.solidify(both(shell, box((0.5, 0.5, 0.5), (1, 0, 0))), cells=40)
    assert found.certificate.valid
    assert (found.report.pieces_in, found.report.pieces_out, found.certificate.cavities) == (2, 2, 1)
    assert found.report.volume_out == pytest.approx(found.report.volume_in, rel=0.02)


@pytest.mark.parametrize("edge", [0.31, 1.0, 3.0])
def test_an_edge_is_the_longest_of_the_lattice(edge):
    surface = TriangleMesh(*box((10, 4, 7)))
    frame = Frame.around(surface, SolidifyOptions(edge=edge))
    inside = frame.enter(surface.vertices)
    assert inside.min() >= 0
    assert inside.max() <= 1
    np.testing.assert_allclose(frame.leave(inside), surface.vertices, atol=1e-12)
    side = np.array([[0, 0, 0], [frame.cell, 0, 0]])
    assert np.ptp(frame.leave(side)[:, 0]) == pytest.approx(edge)


def test_an_edge_may_have_a_unit():
    by_unit = tetgan.solidify(box((1, 1, 1)), edge="10cm", units="m")
    np.testing.assert_array_equal(
        by_unit.solid.vertices, tetgan.solidify(box((1, 1, 1)), edge=0.1).solid.vertices
    )
    with pytest.raises(UserError, match="'5mm' has a unit"):
        tetgan.solidify(box((1, 1, 1)), edge="5mm")


@pytest.mark.parametrize(
    ("text", "units", "expected"),
    [("0.5", None, 0.5), ("5mm", "m", 0.005), ("1 in", "mm", 25.4), ("2e-1cm", "cm", 0.2), ("3", "mm", 3)],
)
def test_lengths(text, units, expected):
    assert parse_length(text, units, "--edge") == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("text", ["", "mm", "-1", "0", "1e999", "5 miles", "nan", "1-2"])
def test_what_is_no_length(text):
    with pytest.raises(UserError, match="is no length; give a number"):
        parse_length(text, "m", "--edge")


NOT_A_NUMBER = box((1, 1, 1))[0] * np.nan


@pytest.mark.parametrize(
    ("mesh", "reason"),
    [
        ((np.empty((0, 3)), np.empty((0, 3), dtype=int)), "no faces"),
        ((NOT_A_NUMBER, box((1, 1, 1))[1]), "coordinates not finite"),
        ((np.eye(3), np.array([[0, 1, 2]])), "flat"),
        ((np.eye(3), np.array([[0, 1, 9]])), "face index out of range"),
        ((np.eye(4), np.array([[0, 1, 2]])), "expected vertices"),
        ("chair.txt", "no surface format '.txt'"),
        ("absent.ply", "unreadable file"),
    ],
)
def test_garbage_has_a_reason(mesh, reason):
    with pytest.raises(ShapeError, match=reason):
        tetgan.solidify(mesh)


def test_an_edge_too_short_or_too_long_is_refused():
    with pytest.raises(ShapeError, match="make them longer"):
        tetgan.solidify(box((1, 1, 1)), edge=1e-4)
    with pytest.raises(ShapeError, match="too short"):
        tetgan.solidify(box((1, 1, 1)), edge=1e-9)
    with pytest.raises(UserError, match="colour: unknown key"):
        tetgan.solidify(box((1, 1, 1)), colour="red")


def test_an_edge_longer_than_the_mesh_makes_a_solid_or_has_a_reason():
    try:
        found = tetgan.solidify(box((1, 1, 1)), edge=2.0)
    except ShapeError as error:
        assert "make it shorter" in str(error)
    else:
        assert found.certificate.valid


def test_distance_of_two_boxes_by_hand():
    # Every point of one is 0.25 from the other or less, and the middle of a side exactly so.
    one, other = TriangleMesh(*box((1, 1, 1))), TriangleMesh(*box((1.5, 1.5, 1.5)))
    largest, mean = surface_distance(one, other)
    assert largest == pytest.approx(np.sqrt(3) * 0.25, rel=0.05)
    assert 0.25 <= mean < 0.3


def test_the_package_is_light_until_asked():
    code = "import tetgan, sys; assert not {'numpy', 'torch', 'igl'} & set(sys.modules); tetgan.solidify"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)
    with pytest.raises(AttributeError, match="no attribute 'liquefy'"):
        _ = tetgan.liquefy
