"""The boundary goes where it is wanted as far as every tet allows, and no tet turns over."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.tets import dihedral_angles, orientations, tet_volumes
from tetgan.meshing.collared_grid import collared_grid
from tetgan.meshing.injective import move_boundary

constant_fixtures = settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.fixture(scope="module")
def ambient(fine_grid):
    return collared_grid(fine_grid)


@pytest.fixture(scope="module")
def ball(ambient):
    """Occupancy of a ball, and its boundary vertices."""
    middle = ambient.vertices[ambient.tets].mean(axis=1)
    occupancy = np.linalg.norm(middle - 0.5, axis=1) < 0.3
    return occupancy, np.unique(boundary_faces(ambient.tets[occupancy]))


def move(ball, targets, ambient, *, min_dihedral=15.0, rounds=4):
    return move_boundary(*ball, targets, ambient, min_dihedral=min_dihedral, rounds=rounds)


@given(
    seed=st.integers(0, 2**32 - 1),
    size=st.floats(0, 1),
    min_dihedral=st.sampled_from([0.0, 10.0, 20.0, 30.0]),
)
@constant_fixtures
def test_wherever_the_boundary_is_wanted_every_tet_of_space_stays_positive(
    *, seed, size, min_dihedral, ambient, ball
):
    occupancy, boundary = ball
    wanted = ambient.vertices[boundary] + np.random.default_rng(seed).normal(0, size, (len(boundary), 3))
    moved = move(ball, wanted, ambient, min_dihedral=min_dihedral)
    assert (orientations(moved, ambient.tets) == 1).all()
    assert dihedral_angles(moved, ambient.tets[occupancy]).min() >= min_dihedral - 1e-6
    np.testing.assert_array_equal(moved[ambient.pinned], ambient.vertices[ambient.pinned])
    # The tets of space still fill it: none overlaps another.
    assert tet_volumes(moved, ambient.tets).sum() == pytest.approx(1.25**3, abs=1e-12)


def test_a_small_way_is_gone_to_the_end(ambient, ball):
    boundary = ball[1]
    wanted = ambient.vertices[boundary] + np.random.default_rng(0).normal(0, 0.002, (len(boundary), 3))
    np.testing.assert_allclose(move(ball, wanted, ambient)[boundary], wanted, atol=1e-15)


def test_more_rounds_come_nearer(ambient, ball):
    boundary = ball[1]
    wanted = 0.5 + (ambient.vertices[boundary] - 0.5) * 1.25
    left = [np.linalg.norm(move(ball, wanted, ambient, rounds=n)[boundary] - wanted) for n in (1, 4, 12)]
    assert left[0] > left[1] > left[2]


def test_what_is_far_from_the_boundary_stays(ambient, ball):
    boundary = ball[1]
    moved = move(ball, ambient.vertices[boundary] + 0.01, ambient)
    away = np.linalg.norm(ambient.vertices[:, None] - ambient.vertices[boundary], axis=2).min(axis=1)
    np.testing.assert_array_equal(moved[away > 0.3], ambient.vertices[away > 0.3])


def test_vertices_at_the_wall_of_the_cube_may_move(fine_grid):
    ambient = collared_grid(fine_grid)
    full = ambient.with_collar(np.ones(len(fine_grid.tets), dtype=bool))
    boundary = np.unique(boundary_faces(fine_grid.tets))
    wanted = 0.5 + (ambient.vertices[boundary] - 0.5) * 1.04
    moved = move((full, boundary), wanted, ambient)
    np.testing.assert_allclose(moved[boundary], wanted, atol=1e-15)
