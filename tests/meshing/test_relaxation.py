"""Steps within bounds, and the gradient that they go down."""

import numpy as np
import pytest

from tetgan.geometry.tets import dihedral_angles, tet_volumes
from tetgan.grids.lattice import open_lattice
from tetgan.meshing.relaxation import Space, bounds_of, relax, shape_gradient, step_within

LATTICE = open_lattice(2, 0)
POINTS = LATTICE.points / 4


@pytest.fixture
def space():
    """All tets solid; the inner vertices are free, and none is on a surface."""
    free = ((POINTS > 0.2) & (POINTS < 0.8)).all(axis=1)
    return Space(
        np.ascontiguousarray(LATTICE.tets.T),
        np.ones(len(LATTICE.tets), dtype=bool),
        np.zeros(len(POINTS), dtype=bool),
        free,
    )


def energy(points):
    total = 0.0
    for corners in points[LATTICE.tets]:
        squares = sum(((corners[i] - corners[j]) ** 2).sum() for i in range(4) for j in range(i))
        volume = np.linalg.det(corners[1:] - corners[0])
        total += squares**1.5 / volume / (6**1.5 * np.sqrt(2))
    return total


def test_a_regular_tet_has_one():
    regular = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])[[0, 1, 3, 2]]
    corners = np.array([[0], [1], [2], [3]])
    if np.linalg.det(regular[1:] - regular[0]) < 0:
        regular = regular[[0, 1, 3, 2]]
    gradient, curvature = shape_gradient(regular.T, corners)
    np.testing.assert_allclose(gradient, 0, atol=1e-12)
    # 36 q / S with S = 6 · 8.
    np.testing.assert_allclose(curvature, 36 / 48)


def test_the_gradient_is_that_of_the_energy():
    rng = np.random.default_rng(0)
    points = POINTS + rng.normal(scale=0.02, size=POINTS.shape)
    gradient, _ = shape_gradient(points.T, LATTICE.tets.T)
    for vertex in rng.choice(len(points), 5, replace=False):
        for axis in range(3):
            step = np.zeros_like(points)
            step[vertex, axis] = 1e-6
            slope = (energy(points + step) - energy(points - step)) / 2e-6
            assert gradient[axis, vertex] == pytest.approx(slope, rel=1e-5, abs=1e-4)


def test_steps_stay_within_bounds(space):
    bounds = bounds_of(POINTS, space, 20.0)
    rng = np.random.default_rng(1)
    wild = np.where(space.free, rng.normal(scale=0.3, size=(3, len(POINTS))), 0.0)
    moved = step_within(POINTS.T, wild, space, bounds).T
    assert (moved != POINTS).any()
    assert dihedral_angles(moved, LATTICE.tets).min() >= 20.0 - 1e-6
    assert (tet_volumes(moved, LATTICE.tets) > 0).all()
    np.testing.assert_array_equal(moved[~space.free], POINTS[~space.free])


def test_outside_a_volume_is_all_that_is_kept(space):
    outside = space._replace(inside=np.zeros(len(LATTICE.tets), dtype=bool))
    bounds = bounds_of(POINTS, outside, 20.0)
    vertex = int(np.flatnonzero(space.free)[0])
    step = np.zeros((3, len(POINTS)))
    step[:, vertex] = 0.2
    moved = step_within(POINTS.T, step, outside, bounds).T
    assert dihedral_angles(moved, LATTICE.tets).min() < 20
    assert (tet_volumes(moved, LATTICE.tets) >= 0.02 * tet_volumes(POINTS, LATTICE.tets) - 1e-15).all()


def test_a_step_that_does_no_harm_is_taken_whole(space):
    step = np.where(space.free, 0.01, 0.0) * np.ones((3, 1))
    moved = step_within(POINTS.T, step, space, bounds_of(POINTS, space, 15.0))
    np.testing.assert_array_equal(moved, POINTS.T + step)


def test_relaxation_makes_better_tets(space):
    rng = np.random.default_rng(2)
    spoiled = POINTS + np.where(space.free[:, None], rng.uniform(-0.05, 0.05, POINTS.shape), 0.0)
    bounds = bounds_of(spoiled, space, 5.0)
    relaxed = relax(spoiled, spoiled, lambda places: places, space, bounds, cell=0.5, rounds=20)
    assert energy(relaxed) < energy(spoiled)
    assert dihedral_angles(relaxed, LATTICE.tets).min() > dihedral_angles(spoiled, LATTICE.tets).min()


def test_the_surface_ends_where_it_is_projected(space):
    plane = space._replace(surface=np.abs(POINTS[:, 0] - 0.5) < 1e-9)
    plane = plane._replace(free=plane.free & ~plane.surface, surface=plane.surface & space.free)

    def project(places):
        return np.column_stack([np.full(len(places), 0.53), places[:, 1:]])

    targets = POINTS + np.array([0.03, 0.0, 0.0])
    moved = relax(POINTS, targets, project, plane, bounds_of(POINTS, plane, 15.0), cell=0.5, rounds=3)
    np.testing.assert_allclose(moved[plane.surface, 0], 0.53)
    fixed = ~plane.surface & ~plane.free
    np.testing.assert_array_equal(moved[fixed], POINTS[fixed])
