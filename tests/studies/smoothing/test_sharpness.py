"""Bends of solids with known dihedral angles."""

import numpy as np
import pytest
import trimesh

from tetgan.studies.smoothing.rows import measure_bends


def test_a_cube_bends_by_90_degrees_at_its_edges_and_nowhere_else(cube):
    bends = measure_bends(*cube)
    assert sorted(np.round(bends.angles, 9)) == [0.0] * 6 + [90.0] * 12
    edges, diagonals = 12.0, 6 * np.sqrt(2)
    assert bends.lengths.sum() == pytest.approx(edges + diagonals)
    assert bends.share_above(30) == pytest.approx(edges / (edges + diagonals))
    assert bends.share_above(90.1) == 0
    assert bends.percentile(95) == pytest.approx(90)
    assert bends.percentile(30) == pytest.approx(0)
    flat, square, folded = bends.histogram(60).items()
    assert flat == ("bend_0_60", pytest.approx(diagonals / (edges + diagonals)))
    assert square == ("bend_60_120", pytest.approx(edges / (edges + diagonals)))
    assert folded == ("bend_120_180", 0)


def test_an_icosahedron():
    mesh = trimesh.creation.icosahedron()
    bends = measure_bends(np.array(mesh.vertices), np.array(mesh.faces))
    np.testing.assert_allclose(bends.angles, 180 - np.degrees(np.arccos(-np.sqrt(5) / 3)))
    assert len(bends.angles) == 30


def test_it_agrees_with_trimesh_on_a_bumpy_ball(ball):
    vertices, faces = ball
    vertices = vertices + np.random.default_rng(0).normal(scale=0.01, size=vertices.shape)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    np.testing.assert_allclose(
        np.sort(measure_bends(vertices, faces).angles),
        np.sort(np.degrees(mesh.face_adjacency_angles)),
        atol=1e-5,
    )


def test_edges_with_one_face_or_three_are_left_out():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0]])
    assert len(measure_bends(vertices, np.array([[0, 1, 2]])).angles) == 0
    assert len(measure_bends(vertices, np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]])).angles) == 0
    two = measure_bends(vertices, np.array([[0, 1, 2], [1, 0, 3]]))
    np.testing.assert_allclose(two.angles, [90])


def test_size_and_place_play_no_part(ball):
    vertices, faces = ball
    turn = trimesh.transformations.random_rotation_matrix(np.array([0.1, 0.2, 0.3]))[:3, :3]
    one, other = measure_bends(vertices, faces), measure_bends(7 * vertices @ turn.T + 3, faces)
    assert one.distance(other) == pytest.approx(0, abs=1e-6)
    assert one.percentile(50) == pytest.approx(other.percentile(50))


def test_distance_between_distributions_is_in_degrees(cube):
    vertices, faces = cube
    bends = measure_bends(vertices, faces)
    flat = measure_bends(
        np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]])
    )
    assert bends.distance(flat) == pytest.approx(90 * bends.share_above(30))
    assert bends.distance(bends) == 0


def test_points_of_a_cube_s_creases_lie_on_its_edges(cube):
    points = measure_bends(*cube).draw(30, 600, seed=0)
    on_wall = np.isclose(points, 0) | np.isclose(points, 1)
    assert (on_wall.sum(axis=1) >= 2).all()
    along = (~on_wall).argmax(axis=1)
    assert np.bincount(along, minlength=3).min() > 140  # 200 expected along each axis, deviation 12
    assert measure_bends(*cube).draw(120, 10, seed=0).shape == (0, 3)


def test_nothing_has_no_sharpness(cube):
    vertices, faces = cube
    nothing = measure_bends(vertices, faces[:0])
    assert np.isnan(nothing.percentile(95))
    assert np.isnan(nothing.share_above(30))
    assert set(nothing.histogram(90).values()) == {0}
