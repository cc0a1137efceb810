"""Occupancy becomes one with a manifold boundary, by as little as may be."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.boundary import Boundary
from tetgan.meshing.collared_grid import collared_grid
from tetgan.meshing.manifold import boundary_defects, make_manifold

constant_fixtures = settings(
    max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.fixture(scope="module")
def ambient(grid):
    return collared_grid(grid)


def is_manifold(occupancy, ambient):
    boundary = Boundary(boundary_faces(ambient.tets[occupancy]))
    return boundary.nonmanifold_edges == 0 and boundary.nonmanifold_vertices == 0


def only(ambient, *tets):
    return np.isin(np.arange(len(ambient.tets)), tets)


def uniform(ambient, empty=1.0):
    """Every tet costs the same to fill, and `empty` times as much to empty; none of the collar may change."""
    cost = np.full(len(ambient.tets), float(empty))
    cost[ambient.grid_tets :] = np.inf
    return cost


def pair_sharing(ambient, corners):
    """A tet in the middle of the grid, and another with just `corners` of its corners."""
    middle = np.linalg.norm(ambient.vertices[ambient.tets].mean(axis=1) - 0.5, axis=1).argmin()
    shared = np.isin(ambient.tets[: ambient.grid_tets], ambient.tets[middle]).sum(axis=1)
    return int(middle), int(np.flatnonzero(shared == corners)[0])


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.01, 0.99))
@constant_fixtures
def test_defects_are_zero_exactly_where_the_boundary_is_manifold(seed, share, ambient):
    rng = np.random.default_rng(seed)
    ball = np.linalg.norm(ambient.vertices[ambient.tets].mean(axis=1) - 0.5, axis=1) < rng.uniform(0.1, 0.5)
    occupancy = ball | (rng.random(len(ball)) < share * rng.choice([0, 0.01, 1]))
    occupancy[ambient.grid_tets :] = False
    assert (not boundary_defects(occupancy, ambient).any()) == is_manifold(occupancy, ambient)


@pytest.mark.parametrize(("corners", "defect"), [(1, 1), (2, 2), (3, 0)])
def test_two_tets_have_a_defect_at_every_corner_they_share_unless_it_is_a_face(ambient, corners, defect):
    occupancy = only(ambient, *pair_sharing(ambient, corners))
    assert boundary_defects(occupancy, ambient).sum() == defect


@pytest.mark.parametrize("corners", [1, 2])
def test_of_two_tets_one_goes_when_that_is_cheapest(ambient, corners):
    one, other = pair_sharing(ambient, corners)
    cost = uniform(ambient)
    cost[one] = 0.5
    changed = make_manifold(only(ambient, one, other), ambient, cost)
    np.testing.assert_array_equal(np.flatnonzero(changed), [other])


@pytest.mark.parametrize("corners", [1, 2])
def test_of_two_tets_both_stay_when_emptying_costs_too_much(ambient, corners):
    pair = only(ambient, *pair_sharing(ambient, corners))
    cost = uniform(ambient)
    cost[pair] = 1000
    changed = make_manifold(pair, ambient, cost)
    assert changed[pair].all()
    assert is_manifold(changed, ambient)


def test_a_gap_at_an_edge_is_filled_by_the_fewest_tets(ambient):
    # By trying every set of tets around the edge: the fewest that join the two without a new fault.
    one, other = pair_sharing(ambient, 2)
    pair = only(ambient, one, other)
    edge = np.intersect1d(ambient.tets[one], ambient.tets[other])
    ring = np.flatnonzero((np.isin(ambient.tets, edge).sum(axis=1) == 2) & ~pair)
    fewest = next(
        count
        for count in range(1, len(ring) + 1)
        if any(is_manifold(pair | only(ambient, *some), ambient) for some in combinations(ring, count))
    )
    cost = uniform(ambient)
    cost[pair] = 1000
    assert (make_manifold(pair, ambient, cost) & ~pair).sum() == fewest


@pytest.mark.parametrize("corners", [1, 2])
def test_a_bow_tie_of_holes_is_mended_too(ambient, corners):
    full = ambient.with_collar(np.ones(ambient.grid_tets, dtype=bool))
    holes = only(ambient, *pair_sharing(ambient, corners))
    changed = make_manifold(full & ~holes, ambient, uniform(ambient))
    assert is_manifold(changed, ambient)
    assert (changed != (full & ~holes)).sum() == 1


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0, 1), empty=st.sampled_from([0.25, 1, 4]))
@constant_fixtures
def test_noise_ends_manifold(seed, share, empty, ambient):
    occupancy = ambient.with_collar(np.random.default_rng(seed).random(ambient.grid_tets) < share)
    changed = make_manifold(
        occupancy, ambient, np.where(occupancy, uniform(ambient, empty), uniform(ambient))
    )
    assert is_manifold(changed, ambient)
    assert not changed[ambient.grid_tets :].any()


def test_what_is_manifold_is_left_alone(ambient):
    for occupancy in (np.zeros(ambient.grid_tets, bool), np.ones(ambient.grid_tets, bool)):
        given_occupancy = ambient.with_collar(occupancy)
        np.testing.assert_array_equal(
            make_manifold(given_occupancy, ambient, uniform(ambient)), given_occupancy
        )


def test_no_single_change_can_be_taken_back(ambient):
    occupancy = ambient.with_collar(np.random.default_rng(5).random(ambient.grid_tets) < 0.4)
    changed = make_manifold(occupancy, ambient, uniform(ambient))
    for tet in np.flatnonzero(changed != occupancy):
        assert not is_manifold(changed ^ only(ambient, tet), ambient)
