"""Which points a surface winds around."""

import numpy as np
import pytest
import trimesh

from tetgan.geometry.inside import is_inside

BOX = trimesh.creation.box((1.0, 1.0, 1.0))
FACES = np.array(BOX.faces, dtype=np.int64)
POINTS = np.random.default_rng(0).random((4000, 3)) * 2 - 1


def inside(points, faces, **how):
    return is_inside(points, np.array(BOX.vertices), faces, **how)


def test_points_of_a_box():
    np.testing.assert_array_equal(inside(POINTS, FACES), (np.abs(POINTS) < 0.5).all(axis=1))


def test_a_hole_of_a_torus_is_outside():
    torus = trimesh.creation.torus(0.3, 0.1)
    points = np.array([[0.0, 0, 0], [0.3, 0, 0], [0, -0.3, 0.05], [0.3, 0, 0.2]])
    found = is_inside(points, np.array(torus.vertices), np.array(torus.faces, dtype=np.int64))
    assert found.tolist() == [False, True, True, False]


def test_a_box_inside_out_has_an_inside_only_if_asked_either_way():
    turned = FACES[:, ::-1]
    assert not inside(POINTS, turned).any()
    np.testing.assert_array_equal(inside(POINTS, turned, either_way=True), inside(POINTS, FACES))


def test_a_box_without_a_lid_still_has_most_of_its_inside():
    lid = (np.array(BOX.vertices)[FACES][:, :, 2] > 0.4).all(axis=1)
    depths = np.array([[0, 0, -0.4], [0.2, 0.1, -0.1], [0, 0, 0.7]])
    assert lid.sum() == 2
    assert inside(depths, FACES[~lid]).tolist() == [True, True, False]


def test_a_mesh_without_faces_is_refused():
    with pytest.raises(ValueError, match="without faces"):
        inside(POINTS, FACES[:0])
