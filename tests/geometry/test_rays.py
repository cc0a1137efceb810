"""Rays against a box of side 1 about the origin."""

import numpy as np
import pytest
import trimesh

from tetgan.geometry.rays import Visibility, spread_directions

BOX = Visibility(np.array(trimesh.creation.box().triangles))
ALONG = np.array([1.0, 0, 0])
ORIGINS = np.array([[-2.0, 0.1, 0.2], [0, 0.1, 0.2], [2, 0.1, 0.2], [-2, 3, 0]])


def test_distances_to_the_first_wall():
    directions = np.tile(ALONG, (4, 1))
    assert BOX.distances(ORIGINS, directions).tolist() == pytest.approx([1.5, 0.5, np.inf, np.inf])


def test_the_first_face_is_one_of_that_wall():
    faces, distances = BOX.first_faces(ORIGINS, ALONG)
    corners = np.array(trimesh.creation.box().triangles)
    assert (corners[faces[0]][:, 0] == -0.5).all()
    assert (corners[faces[1]][:, 0] == 0.5).all()
    assert faces[2:].tolist() == [-1, -1]
    assert np.isinf(distances[2:]).all()


def test_a_wall_is_as_thick_as_the_box_across_it():
    slanted = np.array([0.8, 0.6, 0])
    assert BOX.first_wall(np.array([[-2.0, 0, 0]]), ALONG).tolist() == pytest.approx([1.0], abs=1e-4)
    # From the wall x = -1/2 at y = -0.3 it leaves through x = 1/2 at y = 0.45: 1.25 long, 1 across.
    start = np.array([[-0.5, -0.3, 0]]) - slanted
    assert BOX.first_wall(start, slanted).tolist() == pytest.approx([1.0], abs=1e-4)


def test_a_wall_beyond_reach_does_not_hide_the_outside():
    assert BOX.sees_out(ORIGINS, ALONG[None]).tolist() == [False, False, True, True]
    assert BOX.sees_out(ORIGINS, ALONG[None], reach=1.0).tolist() == [True, False, True, True]
    # The reach counts lengths of the direction.
    assert BOX.sees_out(ORIGINS, 2 * ALONG[None], reach=1.0).tolist() == [False, False, True, True]


def test_the_inside_sees_nothing_and_the_outside_what_is_on_its_side():
    points = np.array([[0.0, 0, 0], [0.5001, 0, 0]])
    normals = np.tile(ALONG, (2, 1))
    assert BOX.sees_out_on_side(points, normals, 32).tolist() == [False, True]


def test_no_rays_have_no_answers():
    assert BOX.sees_out(np.empty((0, 3)), ALONG[None]).shape == (0,)


def test_directions_are_unit_and_fill_the_upper_half_evenly():
    directions = spread_directions(64)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1)
    assert directions[:, 1].min() > 0
    # An even half sphere has its middle at half the radius.
    np.testing.assert_allclose(directions.mean(axis=0), [0, 0.5, 0], atol=0.02)
