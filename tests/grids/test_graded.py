"""Graded grids: tets that share whole faces, whatever is chosen, and the dense grid where all is."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import FACES
from tetgan.grids.graded import graded_grid
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.grids.lattice import cube_lattice


def everything(level, corners):
    return np.ones(len(corners), dtype=bool)


def near(point, reach=0.0):
    """Chooses tets with a point that may be within `reach` of `point`."""

    def choose(level, corners):
        centroids = corners.mean(axis=1)
        radii = np.linalg.norm(corners - centroids[:, None], axis=2).max(axis=1)
        return np.linalg.norm(centroids - point, axis=1) <= radii + reach

    return choose


def at_random(seed, share, chosen):
    """Chooses a share of the tets, and adds their corners to `chosen`."""
    rng = np.random.default_rng(seed)

    def choose(level, corners):
        mask = rng.random(len(corners)) < share
        chosen.update(as_sets(corners[mask]))
        return mask

    return choose


def as_sets(corners):
    return {frozenset(map(tuple, tet)) for tet in corners.tolist()}


@cache
def dense_levels(cells, depth):
    return [as_sets(grid.vertices[grid.tets]) for grid in build_hierarchy(cells, depth).levels]


def assert_conforming(grid, cells, depth):
    """Tets that fill the cube, each inner face of exactly two of them, and no vertex on an edge of others."""
    assert grid.volumes.min() > 0
    assert grid.volumes.sum() == pytest.approx(1, abs=1e-12)
    tets, slots = np.nonzero(grid.neighbors < 0)  # raises where a face has three tets
    corners = grid.vertices[np.take_along_axis(grid.tets[tets], FACES[slots], axis=1)]
    assert ((corners == 0).all(axis=1) | (corners == 1).all(axis=1)).any(axis=1).all()
    unit = 4 * cells * 2**depth
    points = np.rint(grid.vertices * unit).astype(int)
    midpoints = points[grid.edges].sum(axis=1) // 2
    assert not {*map(tuple, points.tolist())} & {*map(tuple, midpoints.tolist())}
    assert len(np.unique(points, axis=0)) == len(points)


def assert_graded(grid, depth):
    """Levels within one of each other at every vertex's edges, and pieces where they differ."""
    assert not grid.green[grid.level == depth].any()
    sides = grid.tets[:, [0, 0, 0, 1, 1, 2]], grid.tets[:, [1, 2, 3, 2, 3, 3]]
    keys = np.minimum(*sides) * len(grid.vertices) + np.maximum(*sides)
    _, edge = np.unique(keys, return_inverse=True)
    levels = np.repeat(grid.level, 6)
    lowest = np.full(edge.max() + 1, depth)
    highest = np.zeros(edge.max() + 1, dtype=int)
    np.minimum.at(lowest, edge.ravel(), levels)
    np.maximum.at(highest, edge.ravel(), levels)
    assert (highest - lowest).max() <= 1


@pytest.mark.parametrize(("cells", "depth"), [(1, 0), (1, 3), (2, 2), (3, 2)])
def test_all_chosen_makes_the_dense_grid(cells, depth):
    grid, dense = graded_grid(cells, depth, everything), build_hierarchy(cells, depth).finest
    assert len(grid.vertices) == len(dense.vertices)
    np.testing.assert_array_equal(grid.vertices[grid.tets], dense.vertices[dense.tets])
    assert not grid.green.any()
    assert (grid.level == depth).all()


def test_none_chosen_leaves_the_lattice():
    grid, lattice = graded_grid(2, 3, lambda level, corners: ~everything(level, corners)), cube_lattice(2)
    np.testing.assert_array_equal(grid.vertices[grid.tets], lattice.vertices[lattice.tets])
    assert not grid.level.any()


@given(
    seed=st.integers(0, 2**32 - 1),
    share=st.sampled_from([0.01, 0.05, 0.2, 0.5, 0.9]),
    lattice=st.sampled_from([(1, 1), (1, 2), (1, 3), (2, 1), (2, 2)]),
)
@settings(max_examples=30, deadline=None)
def test_any_choice_can_be_closed(seed, share, lattice):
    cells, depth = lattice
    chosen = set()
    grid = graded_grid(cells, depth, at_random(seed, share, chosen))
    assert_conforming(grid, cells, depth)
    assert_graded(grid, depth)
    whole = grid.vertices[grid.tets[~grid.green]]
    assert not chosen & as_sets(whole)
    # Whole tets are those of the dense grids.
    for level, dense in enumerate(dense_levels(cells, depth)):
        assert as_sets(whole[grid.level[~grid.green] == level]) <= dense


@given(point=st.tuples(*[st.floats(0, 1)] * 3), depth=st.integers(1, 6))
@settings(max_examples=20, deadline=None)
def test_a_point_costs_as_much_at_every_level(point, depth):
    reach = 1 / (2 * 2**depth)
    grid = graded_grid(2, depth, near(point, reach))
    assert_conforming(grid, 2, depth)
    assert_graded(grid, depth)
    assert len(grid.tets) < 144 + 3000 * depth
    close = np.linalg.norm(grid.vertices - point, axis=1) <= reach
    assert close.any()
    assert (grid.level[close[grid.tets].any(axis=1)] == depth).all()
