"""Exact points on a mesh, on the side that the planes speak of."""

import numpy as np
import trimesh

from tetgan.meshing.mesh_surface import MeshSurface, Triangles
from tetgan.meshing.planes import Planes

MIDDLE = np.array([0.5, 0.5, 0.5])
PLATE = trimesh.creation.box((1, 1, 0.02)).apply_translation(MIDDLE)  # 0.01 above and below the middle
TRIANGLES = Triangles(np.array(PLATE.vertices), np.array(PLATE.faces))


def planes_of_top(height):
    """Planes of centroids above the plate that take its top to lie at a height."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, 9), np.linspace(-0.5, 0.5, 9))
    centroids = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.1)], axis=1)
    normals = np.tile([0.0, 0.0, 1.0], (x.size, 1))
    return Planes(MIDDLE + centroids, centroids[:, 2] - height, normals)


def test_closest_points_and_their_normals():
    found = TRIANGLES.closest(np.array([[0.1, 0.2, 0.3], [-0.7, 0.1, 0.0]]) + MIDDLE)
    np.testing.assert_allclose(found.points - MIDDLE, [[0.1, 0.2, 0.01], [-0.5, 0.1, 0]], atol=1e-12)
    np.testing.assert_allclose(found.squared, [0.29**2, 0.04], rtol=1e-12)
    np.testing.assert_allclose(found.normals, [[0, 0, 1], [-1, 0, 0]], atol=1e-12)
    assert TRIANGLES.closest(np.empty((0, 3))).points.shape == (0, 3)


def projected(height, place, reach):
    surface = MeshSurface(planes_of_top(height), TRIANGLES)
    points = np.array([place]) + MIDDLE
    return surface.projection(points, reach)(points) - MIDDLE


def test_planes_that_err_a_little_are_mended():
    np.testing.assert_allclose(projected(0.013, [0.1, 0.1, 0.05], 0.1), [[0.1, 0.1, 0.01]], atol=1e-12)


def test_the_other_side_of_a_thin_part_is_not_taken():
    # The planes err so much that its bottom is nearer; nor is what lies out of reach.
    for height, reach in ((-0.013, 0.1), (0.05, 0.03)):
        np.testing.assert_allclose(
            projected(height, [0.1, 0.1, 0.06], reach), [[0.1, 0.1, height]], atol=1e-12
        )
