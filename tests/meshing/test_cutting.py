"""Tets of the lattice cut by signs: volumes, angles, manifold boundary, in every case there is."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import face_neighbors
from tetgan.geometry.tets import dihedral_angles, tet_volumes
from tetgan.grids.lattice import open_lattice
from tetgan.meshing.cutting import cut_tets
from tetgan.solids.certificate import certify

LATTICE = open_lattice(2, 1)
LEAST = np.degrees(np.arccos(7 / np.sqrt(60)))
CASES = [signs for signs in product((-1, 0, 1), repeat=4) if any(signs)]


def points_of(lattice, cut):
    vertices = lattice.points.astype(float)
    return np.concatenate([vertices, vertices[cut.edges].mean(axis=1)])


def inner_signs(rng, share):
    """Random signs, + on the hull."""
    hull = np.unique(LATTICE.tets[(face_neighbors(LATTICE.tets) < 0).any(axis=1)])
    signs = np.where(rng.random(len(LATTICE.points)) < share, -1, 1)
    signs[hull] = 1
    return signs


def positive(points, tets):
    return np.where((tet_volumes(points, tets) > 0)[:, None], tets, tets[:, [0, 1, 3, 2]])


def test_every_case_fills_its_tet_with_good_tets():
    # Every pattern of signs in every direction that a tet of the lattice has, each on vertices of its own.
    around = LATTICE.tets[(LATTICE.tets == np.abs(LATTICE.points - 2).sum(1).argmin()).any(axis=1)]
    assert len(around) == 24
    signs = np.tile(CASES, (24, 1)).ravel()
    lattice_points = LATTICE.points[np.repeat(around, len(CASES), axis=0)].reshape(-1, 3)
    tets = np.arange(len(signs)).reshape(-1, 4)
    cut = cut_tets(tets, signs, lattice_points)
    points = np.concatenate([lattice_points, lattice_points[cut.edges].mean(axis=1)])
    owner = np.concatenate([np.arange(len(signs)), cut.edges[:, 0]]) // 4
    filled = np.zeros(len(tets))
    for pieces, side in ((cut.inside, -1), (cut.outside, 1)):
        volumes = np.abs(tet_volumes(points, pieces))
        assert volumes.min() > 0
        np.add.at(filled, owner[pieces[:, 0]], volumes)
        np.testing.assert_array_equal(
            np.isin(np.arange(len(tets)), owner[pieces]), (signs.reshape(-1, 4) == side).any(axis=1)
        )
        assert dihedral_angles(points, pieces).min() == pytest.approx(LEAST)
    np.testing.assert_allclose(filled, 2 / 3)


def test_a_corner_by_hand():
    tet = LATTICE.tets[0]
    signs = np.ones(len(LATTICE.points), dtype=int)
    signs[tet[2]] = -1
    cut = cut_tets(tet[None], signs, LATTICE.points)
    assert {frozenset(edge) for edge in cut.edges.tolist()} == {
        frozenset((int(tet[2]), int(other))) for other in np.delete(tet, 2)
    }
    nodes = len(signs) + np.arange(3)
    assert set(cut.inside[0].tolist()) == {tet[2], *nodes}
    assert np.abs(tet_volumes(points_of(LATTICE, cut), cut.inside)).sum() == pytest.approx(2 / 3 / 8)


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.05, 0.95))
@settings(max_examples=20, deadline=None)
def test_any_signs_give_a_valid_solid(seed, share):
    signs = inner_signs(np.random.default_rng(seed), share)
    cut = cut_tets(LATTICE.tets, signs, LATTICE.points)
    points = points_of(LATTICE, cut)
    inside = positive(points, cut.inside)
    found = certify(points, inside)
    assert found.reasons in ([], ["no tets"])
    if found.tets:
        assert found.min_dihedral >= LEAST - 1e-6
    # Both sides together are the lattice: conforming, nothing lost, no side facing two tets on one side.
    whole = certify(points, np.concatenate([inside, positive(points, cut.outside)]))
    assert whole.crowded_faces == whole.folded_faces == 0
    assert whole.volume == pytest.approx(2 / 3 * len(LATTICE.tets))
