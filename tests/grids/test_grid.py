"""Neighbours, edges, centroids and digests of a grid."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import boundary_faces, face_neighbors, unique_edges
from tetgan.geometry.tets import tet_volumes
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy

CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
ONE_TET = np.array([[0, 1, 2, 3]])


def naive_neighbors(tets):
    """Compare every face with every other."""
    owners = {}
    for tet, corners in enumerate(tets):
        for slot in range(4):
            face = frozenset(np.delete(corners, slot).tolist())
            owners.setdefault(face, []).append((tet, slot))
    neighbors = np.full((len(tets), 4), -1)
    for sides in owners.values():
        for (one, slot), (other, other_slot) in combinations(sides, 2):
            neighbors[one, slot], neighbors[other, other_slot] = other, one
    return neighbors


@given(
    cells=st.integers(1, 3), depth=st.integers(0, 1), share=st.floats(0, 1), seed=st.integers(0, 2**32 - 1)
)
@settings(max_examples=30, deadline=None)
def test_neighbors_of_any_part_of_a_grid_agree_with_a_naive_search(cells, depth, share, seed):
    tets = build_hierarchy(cells, depth).finest.tets
    rng = np.random.default_rng(seed)
    part = rng.permuted(tets[rng.random(len(tets)) < share], axis=1)
    np.testing.assert_array_equal(face_neighbors(part), naive_neighbors(part))


def test_neighbors_are_mutual_and_share_the_face_of_their_slot():
    grid = build_hierarchy(2, 2).finest
    for slot in range(4):
        tets = np.flatnonzero(grid.neighbors[:, slot] >= 0)
        across = grid.neighbors[tets, slot]
        assert (grid.neighbors[across] == tets[:, None]).sum(axis=1).tolist() == [1] * len(tets)
        face = np.delete(grid.tets[tets], slot, axis=1)
        assert (face[:, :, None] == grid.tets[across][:, None]).any(axis=2).all()


def test_a_face_of_three_tets_is_refused():
    with pytest.raises(ValueError, match="more than two tets"):
        face_neighbors(np.array([[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]))


def test_the_boundary_of_one_tet_faces_outward():
    faces = boundary_faces(ONE_TET)
    assert len(faces) == 4
    corners = CORNER[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = corners.mean(axis=1) - CORNER.mean(axis=0)
    assert (np.einsum("fc,fc->f", normals, outward) > 0).all()


def test_the_boundary_of_a_grid_is_the_closed_cube():
    grid = build_hierarchy(2, 1).finest
    a, b, c = np.moveaxis(grid.vertices[boundary_faces(grid.tets)], 1, 0)
    # The divergence theorem: outward faces enclose the volume of the cube, over its six sides of area 1.
    assert np.einsum("fc,fc->", a, np.cross(b, c)) / 6 == pytest.approx(1, abs=1e-12)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(6, abs=1e-12)


def test_nothing_has_no_boundary_no_edges_and_no_neighbors():
    nothing = np.empty((0, 4), dtype=np.int64)
    assert face_neighbors(nothing).shape == (0, 4)
    assert boundary_faces(nothing).shape == (0, 3)
    assert unique_edges(nothing)[0].shape == (0, 2)


@given(seed=st.integers(0, 2**32 - 1), corners=st.sampled_from([3, 4]))
@settings(max_examples=30, deadline=None)
def test_edges_agree_with_a_set_of_pairs(seed, corners):
    rng = np.random.default_rng(seed)
    simplices = np.array([rng.choice(9, corners, replace=False) for _ in range(7)])
    edges, edge_of_side = unique_edges(simplices)
    pairs = [[tuple(sorted(pair)) for pair in combinations(row.tolist(), 2)] for row in simplices]
    assert [tuple(edge) for edge in edges.tolist()] == sorted({pair for row in pairs for pair in row})
    assert [[tuple(edges[side].tolist()) for side in row] for row in edge_of_side] == pairs


def test_centroid_and_volume_of_one_tet():
    grid = TetGrid(CORNER, ONE_TET)
    np.testing.assert_allclose(grid.centroids, [[0.25, 0.25, 0.25]])
    np.testing.assert_allclose(grid.volumes, [1 / 6])
    np.testing.assert_allclose(tet_volumes(CORNER, np.array([[1, 0, 2, 3]])), [-1 / 6])


def test_the_digest_sees_every_bit_and_every_shape():
    moved = CORNER.copy()
    moved[0, 0] = np.nextafter(0, 1)
    digests = {TetGrid(vertices, ONE_TET).digest for vertices in (CORNER, moved)}
    digests.add(TetGrid(CORNER, ONE_TET[:, [1, 2, 0, 3]]).digest)
    digests.add(TetGrid(CORNER, ONE_TET[:0]).digest)
    assert len(digests) == 4
    assert TetGrid(CORNER.copy(), ONE_TET.astype(np.int32)).digest in digests
