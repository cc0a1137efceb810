"""Eq. 4, normalised."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import boundary_faces
from tetgan.meshing.smoothing import smooth_vertices

TRIANGLE = np.array([[0, 1, 2]])


def naive_smoothing(vertices, displacement, faces, beta):
    """The equation read aloud, a vertex at a time."""
    around = {vertex: set() for vertex in range(len(vertices))}
    for face in faces.tolist():
        for vertex in face:
            around[vertex] |= set(face) - {vertex}
    smoothed = vertices.copy()
    for vertex, others in around.items():
        total, pulled = 0.0, np.zeros(3)
        for other in others:
            lengths = np.linalg.norm(displacement[vertex]) * np.linalg.norm(displacement[other])
            weight = abs(displacement[vertex] @ displacement[other]) / lengths if lengths else 0.0
            total, pulled = total + weight, pulled + weight * vertices[other]
        if total:
            smoothed[vertex] = beta * vertices[vertex] + (1 - beta) * pulled / total
    return smoothed


@given(seed=st.integers(0, 2**32 - 1), beta=st.floats(0, 1))
@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_it_agrees_with_a_loop(seed, beta, grid):
    rng = np.random.default_rng(seed)
    faces = boundary_faces(grid.tets[rng.random(len(grid.tets)) < 0.3])
    displacement = rng.normal(size=grid.vertices.shape) * rng.integers(0, 2, (len(grid.vertices), 1))
    smoothed = smooth_vertices(grid.vertices, displacement, faces, beta)
    np.testing.assert_allclose(
        smoothed, naive_smoothing(grid.vertices, displacement, faces, beta), atol=1e-12
    )


def test_parallel_displacements_average_the_neighbors():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    along = np.array([[0, 0, 1.0], [0, 0, -3], [0, 0, 2]])  # the cosine's sign and size do not count
    smoothed = smooth_vertices(vertices, along, TRIANGLE, beta=0.5)
    np.testing.assert_allclose(smoothed, [[0.25, 0.25, 0], [0.5, 0.25, 0], [0.25, 0.5, 0]])


def test_no_weight_no_move():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]])
    for displacement in (np.eye(3)[[0, 1, 2, 0]], np.zeros((4, 3))):
        np.testing.assert_array_equal(smooth_vertices(vertices, displacement, TRIANGLE, 0.5), vertices)


@pytest.mark.parametrize("faces", [TRIANGLE, TRIANGLE[:0]])
def test_beta_one_keeps_everything(faces):
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    np.testing.assert_array_equal(smooth_vertices(vertices, np.ones((3, 3)), faces, 1.0), vertices)


def test_an_edge_of_two_faces_counts_once():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    square = np.array([[0, 1, 2], [0, 2, 3]])
    smoothed = smooth_vertices(vertices, np.ones((4, 3)), square, beta=0.0)
    np.testing.assert_allclose(smoothed[0], vertices[1:].mean(axis=0))
