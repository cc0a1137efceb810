"""Quality records against textbook tets and naive counts."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tetgan.grids.adjacency import boundary_faces
from tetgan.meshing.quality import dihedral_angles, quality_record, radius_ratios
from tetgan.meshing.solid import SolidMesh

REGULAR = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TET = np.array([[0, 1, 2, 3]])


def solid(vertices, tets):
    return SolidMesh(vertices, tets, boundary_faces(tets))


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


def test_the_record_of_one_tet():
    record = quality_record(solid(CORNER, TET))
    assert record == {
        "tets": 1,
        "faces": 4,
        "inverted_tets": 0,
        "min_dihedral": pytest.approx(54.7356, abs=1e-4),
        "volume": pytest.approx(1 / 6),
        # Straight in from a face at a corner's right angles: its centroid lies 1/3 under the slanted face.
        "thickness": pytest.approx(1 / 3, abs=1e-5),
        "components": 1,
        "floating": 0.0,
        "manifold_edges": 1.0,
    }


def test_inverted_and_flat_tets_are_counted():
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    vertices = np.concatenate([CORNER, CORNER[[1, 0, 2, 3]] + 3, flat + 6])
    record = quality_record(solid(vertices, np.arange(12).reshape(3, 4)))
    assert record["inverted_tets"] == 2
    assert record["components"] == 3
    assert record["floating"] == pytest.approx(2 / 3)
    assert record["volume"] == pytest.approx(0, abs=1e-12)
    assert record["min_dihedral"] == 0


def test_two_tets_on_one_edge_are_not_manifold():
    # They share the edge 01, which has four faces, and no face: 11 edges in all, two components.
    vertices = np.array([[0.0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]])
    record = quality_record(solid(vertices, np.array([[0, 1, 2, 3], [0, 1, 4, 5]])))
    assert record["components"] == 2
    assert record["manifold_edges"] == pytest.approx(10 / 11)


def test_an_empty_mesh_is_all_zeros():
    record = quality_record(solid(np.empty((0, 3)), np.empty((0, 4), dtype=np.int64)))
    assert set(record.values()) == {0}


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.01, 0.99))
@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_counts_agree_with_naive_ones(seed, share, grid):
    chosen = np.flatnonzero(np.random.default_rng(seed).random(len(grid.tets)) < share)
    if len(chosen) == 0:
        return
    record = quality_record(solid(grid.vertices, grid.tets[chosen]))
    sizes = flood_sizes(set(chosen.tolist()), grid.neighbors)
    assert record["components"] == len(sizes)
    assert record["floating"] == pytest.approx(1 - max(sizes) / len(chosen))
    faces = {}
    for face in boundary_faces(grid.tets[chosen]).tolist():
        for pair in zip(face, face[1:] + face[:1], strict=True):
            edge = frozenset(pair)
            faces[edge] = faces.get(edge, 0) + 1
    assert record["manifold_edges"] == pytest.approx(np.mean([count == 2 for count in faces.values()]))


def flood_sizes(tets, neighbors):
    sizes = []
    while tets:
        before, front = len(tets), [tets.pop()]
        while front:
            for other in neighbors[front.pop()].tolist():
                if other in tets:
                    tets.remove(other)
                    front.append(other)
        sizes.append(before - len(tets))
    return sizes
