"""Occupancy at random points, and signed distance at cells, against primitives with closed forms."""

import numpy as np
import pytest
import trimesh

from tetgan.fields.points import draw_points
from tetgan.fields.voxels import CLAMP, cell_centres, sample_distance


@pytest.fixture(scope="module")
def box():
    """Vertices and faces of a box of sides 0.6, 0.4 and 0.2 about the centre of the cube."""
    mesh = trimesh.creation.box((0.6, 0.4, 0.2))
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64)


def test_points_of_a_box_are_exact(box):
    points, occupancy = draw_points(*box, 5000, 1.1, seed=0)
    reach = np.abs(points.astype(np.float64) - 0.5) - np.array([0.3, 0.2, 0.1])
    np.testing.assert_array_equal(occupancy, (reach < 0).all(axis=1))


def test_points_are_uniform_in_their_box(box):
    points, occupancy = draw_points(*box, 50_000, 1.1, seed=0)
    assert points.dtype == np.float32
    assert points.min() >= -0.0501 and points.max() <= 1.0505  # half precision rounds by up to 5e-4 near 1
    # Share in a region of probability p deviates by sqrt(p (1 - p) / N); five of them.
    inside = 0.6 * 0.4 * 0.2 / 1.1**3
    assert occupancy.mean() == pytest.approx(inside, abs=5 * (inside / 50_000) ** 0.5)
    for axis in range(3):
        counts, _ = np.histogram(points[:, axis], bins=10, range=(-0.05, 1.05))
        assert np.abs(counts - 5000).max() < 5 * 5000**0.5


def test_points_are_those_that_half_precision_keeps(box):
    points, _ = draw_points(*box, 1000, 1.1, seed=0)
    np.testing.assert_array_equal(points.astype(np.float16).astype(np.float32), points)


def test_points_depend_on_the_seed_alone(box):
    one, other = draw_points(*box, 100, 1.1, seed=1), draw_points(*box, 100, 1.1, seed=(2, 3))
    np.testing.assert_array_equal(draw_points(*box, 100, 1.1, seed=1)[0], one[0])
    assert not np.array_equal(one[0], other[0])


def test_distance_of_a_sphere_has_a_closed_form(ball):
    distance = sample_distance(*ball, 32)
    radius = np.linalg.norm(cell_centres(32) - 0.5, axis=-1)
    assert distance.shape == (32, 32, 32)
    assert distance.dtype == np.float32
    # The polyhedron stays within 0.4 and 0.4 cos(edge/2): 0.0022 below the ball at 1,280 faces.
    assert np.abs(distance - np.clip(radius - 0.4, -CLAMP, CLAMP)).max() < 0.003


def test_distance_of_a_box_is_exact_and_its_axes_are_in_order(box):
    distance = sample_distance(*box, 16)
    reach = np.abs(cell_centres(16) - 0.5) - np.array([0.3, 0.2, 0.1])
    outside = np.linalg.norm(reach.clip(min=0), axis=-1)
    expected = np.where(outside > 0, outside, reach.max(axis=-1))
    np.testing.assert_allclose(distance, expected.clip(-CLAMP, CLAMP), atol=1e-7)
    assert (distance[:, 8, 8] < 0).sum() > (distance[8, :, 8] < 0).sum() > (distance[8, 8, :] < 0).sum()


def test_a_mesh_without_faces_is_refused():
    nothing = np.zeros((3, 3)), np.zeros((0, 3), dtype=np.int64)
    with pytest.raises(ValueError, match="without faces"):
        draw_points(*nothing, 10, 1.1, seed=0)
    with pytest.raises(ValueError, match="without faces"):
        sample_distance(*nothing, 8)
