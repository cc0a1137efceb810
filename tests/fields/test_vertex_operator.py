"""Eq. 3 as a matrix."""

import numpy as np

from tetgan.fields.field import vertex_operator
from tetgan.grids.grid import TetGrid


def test_it_agrees_with_the_equation_as_printed(grid):
    displacement = np.random.default_rng(0).normal(size=(len(grid.tets), 3))
    moved = vertex_operator(grid) @ displacement
    for vertex in range(0, len(grid.vertices), 7):
        incident = np.flatnonzero((grid.tets == vertex).any(axis=1))
        weights = 1 / np.linalg.norm(grid.vertices[vertex] - grid.centroids[incident], axis=1)
        expected = (weights[:, None] * displacement[incident]).sum(axis=0) / weights.sum()
        np.testing.assert_allclose(moved[vertex], expected, rtol=1e-12, atol=1e-14)


def test_rows_sum_to_one(grid):
    operator = vertex_operator(grid)
    assert operator.shape == (len(grid.vertices), len(grid.tets))
    assert operator.nnz == 4 * len(grid.tets)
    np.testing.assert_allclose(operator.sum(axis=1), 1, rtol=1e-12)


def test_a_vertex_of_no_tet_stays():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    operator = vertex_operator(TetGrid(vertices, np.array([[0, 1, 2, 3]])))
    np.testing.assert_array_equal((operator @ np.ones((1, 3)))[4], 0)
