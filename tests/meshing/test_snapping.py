"""Vertices drawn onto the surface: the topology stays."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.geometry.tets import tet_volumes
from tetgan.grids.lattice import open_lattice
from tetgan.meshing.cutting import cut_tets
from tetgan.meshing.snapping import snap_vertices
from tetgan.solids.certificate import certify

LATTICE = open_lattice(4, 1)
PLACES = LATTICE.points / 8
CENTRE = int(np.linalg.norm(PLACES - 0.5, axis=1).argmin())


def solid(signs):
    cut = cut_tets(LATTICE.tets, signs, LATTICE.points)
    vertices = LATTICE.points.astype(float)
    points = np.concatenate([vertices, vertices[cut.edges].mean(axis=1)])
    tets = cut.inside
    return certify(points, np.where((tet_volumes(points, tets) > 0)[:, None], tets, tets[:, [0, 1, 3, 2]]))


def inner(signs):
    signs[(PLACES <= 0).any(axis=1) | (PLACES >= 1).any(axis=1)] = 1
    return signs


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.05, 0.95))
@settings(max_examples=25, deadline=None)
def test_noise_keeps_its_topology(seed, share):
    rng = np.random.default_rng(seed)
    signs = inner(np.where(rng.random(len(PLACES)) < share, -1, 1))
    candidates = np.flatnonzero(((PLACES > 0) & (PLACES < 1)).all(axis=1))
    snapped = snap_vertices(LATTICE.tets, signs, candidates, rng.random(len(candidates)))
    assert set(np.unique(snapped)) <= {-1, 0, 1}
    np.testing.assert_array_equal(snapped[snapped != 0], signs[snapped != 0])
    before, after = solid(signs), solid(snapped)
    assert after.reasons in ([], ["no tets"])
    assert (after.components, after.cavities) == (before.components, before.cavities)


def test_most_of_a_smooth_surface_is_snapped():
    distance = np.linalg.norm(PLACES - 0.5, axis=1) - 0.4
    signs = np.where(distance < 0, -1, 1)
    near = np.flatnonzero(np.abs(distance) < 0.08)
    snapped = snap_vertices(LATTICE.tets, signs, near, np.abs(distance[near]))
    assert (snapped[near] == 0).mean() > 0.5
    assert solid(snapped).valid


def test_the_nearer_of_two_neighbours_comes_first():
    signs = np.where(PLACES[:, 0] < 0.45, -1, 1)
    one, other = 0, 0
    cut = LATTICE.tets[np.ptp(signs[LATTICE.tets], axis=1) > 0]
    inner_tets = cut[((PLACES[cut] > 0.2) & (PLACES[cut] < 0.8)).all(axis=(1, 2))]
    one = int(inner_tets[0][signs[inner_tets[0]] < 0][0])
    other = int(inner_tets[0][signs[inner_tets[0]] > 0][0])
    for near, far in ((one, other), (other, one)):
        snapped = snap_vertices(LATTICE.tets, signs, np.array([near, far]), np.array([0.1, 0.2]))
        assert snapped[near] == 0


@pytest.mark.parametrize("side", [-1, 1])
def test_a_vertex_alone_stays(side):
    # Drawn onto the surface it would be nothing, or fill a hole.
    signs = np.full(len(PLACES), -side)
    signs[CENTRE] = side
    np.testing.assert_array_equal(snap_vertices(LATTICE.tets, signs, np.array([CENTRE]), np.zeros(1)), signs)


def test_a_vertex_in_a_thin_plate_stays():
    # One layer of vertices: the outside is on both sides of each.
    signs = inner(np.where(np.abs(PLACES[:, 1] - 0.5) < 1e-9, -1, 1))
    plate = np.flatnonzero(signs < 0)
    middle = plate[np.linalg.norm(PLACES[plate] - 0.5, axis=1) < 0.3]
    snapped = snap_vertices(LATTICE.tets, signs, middle, np.zeros(len(middle)))
    np.testing.assert_array_equal(snapped, signs)


def test_candidates_away_from_the_surface_stay():
    signs = np.where(PLACES[:, 0] < 0.3, -1, 1)
    far = np.flatnonzero(PLACES[:, 0] > 0.7)
    np.testing.assert_array_equal(snap_vertices(LATTICE.tets, signs, far, np.zeros(len(far))), signs)
