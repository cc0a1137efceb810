"""Pinches are opened, or closed by a seam, without a change of occupancy, and space stays filled."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.boundary import Boundary
from tetgan.geometry.tets import dihedral_angles, orientations
from tetgan.meshing.collared_grid import collared_grid
from tetgan.meshing.components import label_by_faces
from tetgan.meshing.manifold import boundary_defects
from tetgan.meshing.occupancy import valid_solid
from tetgan.meshing.opening import open_pinches
from tetgan.meshing.options import MeshingOptions

constant_fixtures = settings(
    max_examples=10, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.fixture(scope="module")
def ambient(fine_grid):
    return collared_grid(fine_grid)


def open_all(occupancy, ambient, min_dihedral=15.0):
    """The solid opened, with all that must hold of any seen to; and what is left."""
    faulty = np.flatnonzero(boundary_defects(occupancy, ambient))
    opened, left = open_pinches(occupancy, faulty, ambient, min_dihedral)
    space, grid_tets = opened.space, ambient.grid_tets
    assert (orientations(space.vertices, space.tets) == 1).all()
    assert space.volumes.sum() == pytest.approx(1.25**3, abs=1e-12)
    if opened.occupancy.any():
        assert dihedral_angles(space.vertices, space.tets[opened.occupancy]).min() >= min_dihedral - 1e-6
    np.testing.assert_array_equal(opened.occupancy[:grid_tets], occupancy[:grid_tets])
    assert not opened.occupancy[space.grid_tets :].any()
    np.testing.assert_array_equal(space.vertices[: len(ambient.vertices)], ambient.vertices)
    np.testing.assert_allclose(opened.blend @ ambient.vertices, space.vertices, atol=1e-12)
    np.testing.assert_array_equal(np.flatnonzero(boundary_defects(opened.occupancy, space)), left)
    assert set(left) <= set(faulty)
    return opened, left


def is_manifold(opened):
    boundary = Boundary(boundary_faces(opened.space.tets[opened.occupancy]))
    return boundary.nonmanifold_edges == 0 and boundary.nonmanifold_vertices == 0


def components(occupancy, space):
    return len(np.unique(label_by_faces(np.flatnonzero(occupancy), space)))


def solid_of(occupancy, grid):
    occupancy = occupancy[: len(grid.tets)]
    return valid_solid(occupancy, np.where(occupancy, 4.0, 1.0), grid, MeshingOptions())


def only(ambient, *tets):
    return np.isin(np.arange(len(ambient.tets)), tets)


def pair_sharing(ambient, corners):
    """A tet in the middle of the grid, and another with just `corners` of its corners."""
    middle = np.linalg.norm(ambient.vertices[ambient.tets].mean(axis=1) - 0.5, axis=1).argmin()
    shared = np.isin(ambient.tets[: ambient.grid_tets], ambient.tets[middle]).sum(axis=1)
    return only(ambient, middle, np.flatnonzero(shared == corners)[0])


def cubes(ambient, *corners):
    """Cubes of half the grid's side, some of which touch at edges or vertices in its middle."""
    octant = (ambient.vertices[ambient.tets[: ambient.grid_tets]].mean(axis=1) > 0.5) @ [4, 2, 1]
    return ambient.with_collar(np.isin(octant, corners))


@pytest.mark.parametrize("corners", [1, 2])
def test_two_tets_that_touch_are_joined_by_a_seam(ambient, corners):
    pair = pair_sharing(ambient, corners)
    opened, left = open_all(pair, ambient)
    assert len(left) == 0
    assert is_manifold(opened)
    assert (opened.gaps, opened.seams) == (0, 1)
    assert components(pair, ambient) == 2
    assert components(opened.occupancy, opened.space) == 1


def test_two_tets_with_a_face_in_common_are_left_alone(ambient):
    opened, _ = open_all(pair_sharing(ambient, 3), ambient)
    assert (opened.gaps, opened.seams) == (0, 0)
    assert opened.space is ambient


def test_what_no_pull_mends_is_mended_by_occupancy(fine_grid, ambient):
    # Cubes that share an edge; the shortest rows of tets between them meet one of them elsewhere too.
    both = cubes(ambient, 0b000, 0b110)
    solid, changes = solid_of(both, fine_grid)
    assert is_manifold(solid)
    assert 0 < changes.changed < 0.01
    assert changes.tets_added + changes.tets_removed + changes.gaps + changes.seams > 0


def test_a_ring_that_touches_itself_along_an_edge(ambient):
    # Two cubes that share an edge, and two more around through which they are connected: one piece.
    ring = cubes(ambient, 0b000, 0b110, 0b001, 0b101, 0b111)
    assert components(ring, ambient) == 1
    opened, left = open_all(ring, ambient)
    assert len(left) == 0
    assert is_manifold(opened)
    assert components(opened.occupancy, opened.space) == 1


@pytest.mark.parametrize("corners", [1, 2])
def test_voids_that_touch_are_parted_or_joined(ambient, corners):
    solid = ambient.with_collar(np.ones(ambient.grid_tets, dtype=bool)) & ~pair_sharing(ambient, corners)
    opened, left = open_all(solid, ambient)
    assert len(left) == 0
    assert is_manifold(opened)


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.02, 0.98))
@constant_fixtures
def test_noise_keeps_its_tets_and_loses_defects(seed, share, grid):
    ambient = collared_grid(grid)
    noise = ambient.with_collar(np.random.default_rng(seed).random(ambient.grid_tets) < share)
    before = boundary_defects(noise, ambient).sum()
    opened, left = open_all(noise, ambient)
    after = boundary_defects(opened.occupancy, opened.space)
    assert after.sum() <= before - opened.gaps - opened.seams
    assert (
        components(opened.occupancy, opened.space) <= max(components(noise, ambient), 1)
        if noise.any()
        else True
    )
    assert len(left) or is_manifold(opened)


def test_components_are_kept_track_of(grid):
    ambient = collared_grid(grid)
    noise = ambient.with_collar(np.random.default_rng(1).random(ambient.grid_tets) < 0.2)
    opened, _ = open_all(noise, ambient)
    tets = np.flatnonzero(opened.occupancy)
    found, kept = label_by_faces(tets, opened.space), opened.component[tets]
    assert len(np.unique(np.stack([found, kept]), axis=1).T) == len(np.unique(found)) == len(np.unique(kept))
    assert (opened.component[~opened.occupancy] == -1).all()


def test_the_same_occupancy_gives_the_same_bits(grid):
    ambient = collared_grid(grid)
    noise = ambient.with_collar(np.random.default_rng(2).random(ambient.grid_tets) < 0.4)
    one, other = (open_all(noise, ambient)[0] for _ in range(2))
    assert one.space.vertices.tobytes() == other.space.vertices.tobytes()
    assert one.space.tets.tobytes() == other.space.tets.tobytes()
