"""Tet meshes, and angles and radius ratios against textbook tets."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.geometry.tets import TetMesh, dihedral_angles, radius_ratios

REGULAR = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TET = np.array([[0, 1, 2, 3]])


def test_dihedral_angles_of_known_tets():
    np.testing.assert_allclose(dihedral_angles(REGULAR, TET), np.degrees(np.arccos(1 / 3)))
    # Three right angles at the corner, in the edges 01 02 03; the others lie against the slanted face.
    slanted = np.degrees(np.arccos(1 / np.sqrt(3)))
    np.testing.assert_allclose(dihedral_angles(CORNER, TET), [[90, 90, 90, slanted, slanted, slanted]])


def test_angles_are_listed_by_edge():
    # A long wedge on the edge 01, of 30 degrees between its two sides.
    half = np.radians(15)
    wedge = np.array(
        [[-9.0, 0, 0], [9, 0, 0], [0, np.cos(half), -np.sin(half)], [0, np.cos(half), np.sin(half)]]
    )
    angles = dihedral_angles(wedge, TET)[0]
    assert angles[0] == pytest.approx(30)
    assert angles.argmin() == 0


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_angles_do_not_change_with_place_size_or_orientation(seed):
    rng = np.random.default_rng(seed)
    vertices = rng.normal(size=(4, 3))
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    angles = dihedral_angles(vertices, TET)
    np.testing.assert_allclose(dihedral_angles(3 * vertices @ turn + 1, TET), angles, atol=1e-5)
    assert ((angles > 0) & (angles < 180)).all()


def test_radius_ratios_of_known_tets():
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    vertices = np.concatenate([REGULAR, CORNER, flat, np.ones((4, 3))])
    # The corner: inner radius 1 / (3 + sqrt 3), outer sqrt(3) / 2.
    corner = 3 / (3 + np.sqrt(3)) / (np.sqrt(3) / 2)
    ratios = radius_ratios(vertices, np.arange(16).reshape(4, 4))
    np.testing.assert_allclose(ratios, [1, corner, 0, 0], atol=1e-12)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_a_radius_ratio_is_that_of_the_two_spheres(seed):
    vertices = np.random.default_rng(seed).normal(size=(4, 3))
    # Centre of the outer sphere: as far from each vertex as from the first.
    edges = vertices[1:] - vertices[0]
    outer = np.linalg.norm(np.linalg.solve(2 * edges, (edges**2).sum(axis=1)))
    faces = [np.delete(vertices, opposite, axis=0) for opposite in range(4)]
    areas = [np.linalg.norm(np.cross(face[1] - face[0], face[2] - face[0])) / 2 for face in faces]
    inner = 3 * abs(np.linalg.det(edges)) / 6 / sum(areas)
    assert radius_ratios(vertices, TET)[0] == pytest.approx(3 * inner / outer, rel=1e-6)


def test_a_tet_with_a_vertex_twice_has_no_angle():
    doubled = REGULAR[[0, 1, 2, 2]]
    assert dihedral_angles(doubled, TET).min() == 0
    assert radius_ratios(doubled, TET) == 0


def test_what_follows_from_two_tets_on_a_face():
    mesh = TetMesh(np.concatenate([CORNER, [[1.0, 1, 1]]]), np.array([[0, 1, 2, 3], [1, 2, 3, 4]]))
    np.testing.assert_allclose(mesh.volumes, [1 / 6, 1 / 3])
    np.testing.assert_allclose(mesh.centroids, [[0.25, 0.25, 0.25], [0.5, 0.5, 0.5]])
    assert mesh.neighbors.tolist() == [[1, -1, -1, -1], [-1, -1, -1, 0]]
    assert mesh.edges.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [1, 4], [2, 3], [2, 4], [3, 4]]
