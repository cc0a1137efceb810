"""Graded grids: tets that share whole faces, whatever is chosen, and the dense grid where all is."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import EDGES, boundary_faces
from tetgan.geometry.tets import dihedral_angles
from tetgan.geometry.triangles import area_normals
from tetgan.grids.graded import graded_grid
from tetgan.grids.hierarchy import subdivide_lattice
from tetgan.grids.lattice import cube_lattice, open_lattice

LATTICES = pytest.mark.parametrize("lattice", [cube_lattice, open_lattice])


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
def dense_levels(lattice, cells, depth):
    return [as_sets(grid.vertices[grid.tets]) for grid in subdivide_lattice(lattice(cells), depth).levels]


def hull_area(grid):
    return np.linalg.norm(area_normals(grid.vertices[boundary_faces(grid.tets)]), axis=1).sum() / 2


def assert_conforming(grid, base, depth):
    """Tets that fill the lattice, have no faces open within it, and no vertex on an edge of others."""
    assert grid.volumes.min() > 0
    assert grid.volumes.sum() == pytest.approx(base.grid.volumes.sum(), rel=1e-12)
    assert grid.neighbors.max() < len(grid.tets)  # raises where a face has three tets
    assert hull_area(grid) == pytest.approx(hull_area(base.grid), rel=1e-12)
    np.testing.assert_array_equal(grid.vertices, grid.points / (base.unit * 2**depth))
    keys = grid.points @ (1 << np.array([40, 20, 0]))  # coordinates are much smaller than 2^20
    assert len(np.unique(keys)) == len(keys)
    assert not np.isin(keys[grid.edges].sum(axis=1), 2 * keys).any()


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


@LATTICES
@pytest.mark.parametrize(("cells", "depth"), [(1, 0), (1, 3), (2, 2), (3, 2)])
def test_all_chosen_makes_the_dense_grid(lattice, cells, depth):
    base = lattice(cells)
    grid, dense = graded_grid(base, depth, everything), subdivide_lattice(base, depth).finest
    assert len(grid.vertices) == len(dense.vertices)
    np.testing.assert_array_equal(grid.vertices[grid.tets], dense.vertices[dense.tets])
    assert not grid.green.any()
    assert (grid.level == depth).all()


@LATTICES
def test_none_chosen_leaves_the_lattice(lattice):
    base = lattice(2)
    grid = graded_grid(base, 3, lambda level, corners: ~everything(level, corners))
    np.testing.assert_array_equal(grid.points[grid.tets], 8 * base.points[base.tets])
    assert not grid.level.any()


@given(
    seed=st.integers(0, 2**32 - 1),
    share=st.sampled_from([0.01, 0.05, 0.2, 0.5, 0.9]),
    lattice=st.sampled_from([cube_lattice, open_lattice]),
    size=st.sampled_from([(1, 1), (1, 2), (1, 3), (2, 1), (2, 2)]),
)
@settings(max_examples=30, deadline=None)
def test_any_choice_can_be_closed(seed, share, lattice, size):
    cells, depth = size
    chosen = set()
    base = lattice(cells)
    grid = graded_grid(base, depth, at_random(seed, share, chosen))
    assert_conforming(grid, base, depth)
    assert_graded(grid, depth)
    whole = grid.vertices[grid.tets[~grid.green]]
    assert not chosen & as_sets(whole)
    # Whole tets are those of the dense grids.
    for level, dense in enumerate(dense_levels(lattice, cells, depth)):
        assert as_sets(whole[grid.level[~grid.green] == level]) <= dense


@given(
    point=st.tuples(*[st.floats(0, 1)] * 3),
    lattice=st.sampled_from([cube_lattice, open_lattice]),
    depth=st.integers(1, 6),
)
@settings(max_examples=30, deadline=None)
def test_a_point_costs_as_much_at_every_level(point, lattice, depth):
    reach = 1 / (2 * 2**depth)
    base = lattice(2)
    grid = graded_grid(base, depth, near(point, reach))
    assert_conforming(grid, base, depth)
    assert_graded(grid, depth)
    assert len(grid.tets) < len(base.tets) + 3000 * depth
    close = np.linalg.norm(grid.vertices - point, axis=1) <= reach
    assert close.any()
    assert (grid.level[close[grid.tets].any(axis=1)] == depth).all()


@pytest.mark.parametrize("lattice", [cube_lattice, open_lattice])
def test_the_children_of_those_chosen_last_come_first_among_the_finest(lattice):
    asked = []

    def choose(level, corners):
        mask = np.random.default_rng(level).random(len(corners)) < 0.3
        asked.append(corners[mask])
        return mask

    grid = graded_grid(lattice(2), 2, choose)
    assert (np.diff(grid.level) >= 0).all()
    parents = asked[-1]
    children = grid.vertices[grid.tets[grid.level == 2]].reshape(-1, 8, 4, 3)
    assert len(children) > len(parents)  # closing adds some
    # The first four are at the parent's corners, in their order.
    np.testing.assert_array_equal(children[: len(parents), range(4), range(4)], parents)


@given(
    seed=st.integers(0, 2**32 - 1),
    share=st.sampled_from([0.01, 0.1, 0.5]),
    size=st.sampled_from([(1, 1), (1, 3), (2, 2)]),
)
@settings(max_examples=20, deadline=None)
def test_an_open_lattice_keeps_its_one_shape(seed, share, size):
    cells, depth = size
    grid = graded_grid(open_lattice(cells), depth, at_random(seed, share, set()))
    corners = grid.points[grid.tets[~grid.green]] >> (depth - grid.level[~grid.green])[:, None, None]
    squares = ((corners[:, EDGES[:, 0]] - corners[:, EDGES[:, 1]]) ** 2).sum(axis=2)
    np.testing.assert_array_equal(np.sort(squares), np.tile([3, 3, 3, 3, 4, 4], (len(squares), 1)))
    np.testing.assert_array_equal(squares == 4, squares[:, ::-1] == 4)  # edges k and 5 - k are opposite
    odd = grid.points % 2
    assert (odd == odd[:, :1]).all()
    finest = odd[grid.tets[grid.level == depth], 0]
    assert (finest.sum(axis=1) == 2).all()
    green = dihedral_angles(grid.vertices, grid.tets[grid.green])
    assert green.min(initial=180) > 30 - 1e-9


def test_green_tets_of_an_open_lattice_have_30_degrees():
    grid = graded_grid(open_lattice(2), 2, near((0.3, 0.4, 0.5)))
    assert dihedral_angles(grid.vertices, grid.tets[grid.green]).min() == pytest.approx(30, abs=1e-9)


@pytest.mark.parametrize(("cells", "depth"), [(1, 0), (1, 2), (2, 2)])
def test_an_open_lattice_refines_into_that_of_half_the_size(cells, depth):
    for level in range(depth + 1):
        grid = graded_grid(open_lattice(cells), level, everything)
        unit = 2 * cells * 2**level
        within = ((grid.points >= 0) & (grid.points <= unit)).all(axis=1)
        everywhere = np.stack(np.meshgrid(*[np.arange(unit + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        odd = everywhere % 2
        np.testing.assert_array_equal(grid.points[within], everywhere[(odd == odd[:, :1]).all(axis=1)])
        # The tets too are those of the finer lattice.
        finer = open_lattice(cells * 2**level, margin=2**level)
        assert as_sets(grid.points[grid.tets]) <= as_sets(finer.points[finer.tets])
