"""Subdivision: volume, order of children, angles, and a digest that never changes."""

import time

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tetgan.geometry.adjacency import EDGES
from tetgan.geometry.tets import dihedral_angles, tet_volumes
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy, subdivide_hierarchy, upsampling_weights
from tetgan.grids.lattice import cube_lattice

# Stored fields and weights hang on these: a change here makes every result on disk useless.
DIGESTS = {
    (1, 2): "b2dfa67364452adbe817bfc7a1f062f5cbd220b7ecb78bb63f7070c811802f94",
    (2, 2): "fe32ba758e25461460986966e07427c5ef79ef7a07f3475c46b7cca3223aad58",
    (2, 3): "e99f470bef20318cec9092008cb4e479b57b485fecfd5d3ed5feb17328edbb76",
    (3, 2): "c91161383192e4ef55833f9043331f6700a2e70678cd91214f7cf12894f0eeed",
    (3, 3): "a6df3a0cadc4d240f42c592b5ea1d9ab58a3194664b33ebc0af8f2dcee742199",
}


@pytest.fixture(scope="module")
def lr():
    return build_hierarchy(2, 3)


@pytest.mark.parametrize(("cells", "depth"), DIGESTS)
def test_grids_are_the_same_on_every_platform(cells, depth):
    assert build_hierarchy(cells, depth).digest == DIGESTS[cells, depth]


def test_the_papers_low_resolution(lr):
    assert [len(grid.tets) for grid in lr.levels] == [144, 1152, 9216, 73728]
    assert lr.depth == 3
    assert lr.coarsest is lr.levels[0]
    assert lr.finest is lr.levels[3]


@pytest.mark.parametrize(("cells", "ratio"), [(1, 1), (2, 2), (3, 2)])
def test_shapes_of_tets_do_not_degrade_with_depth(cells, ratio):
    for depth, grid in enumerate(build_hierarchy(cells, 3).levels):
        assert grid.volumes.min() > 0
        assert grid.volumes.sum() == pytest.approx(1, abs=1e-12)
        assert grid.volumes.max() / grid.volumes.min() == pytest.approx(ratio, rel=1e-9)
        angles = dihedral_angles(grid.vertices, grid.tets)
        low, high = (30, 135) if depth else (45, 90)
        assert angles.min() == pytest.approx(low, abs=1e-6)
        assert angles.max() == pytest.approx(high, abs=1e-6)


@given(corners=st.lists(st.integers(0, 40), min_size=12, max_size=12), order=st.permutations(range(4)))
@settings(max_examples=100, deadline=None)
def test_children_fill_their_parent(corners, order):
    vertices = np.array(corners).reshape(4, 3) / 40
    tets = np.array([order])
    if tet_volumes(vertices, tets)[0] <= 0:
        tets = tets[:, [0, 1, 3, 2]]
    volume = tet_volumes(vertices, tets)[0]
    assume(volume > 1e-9)
    fine = subdivide_hierarchy(TetGrid(vertices, tets), 1).finest
    np.testing.assert_allclose(fine.volumes, volume / 8, rtol=1e-3, atol=1e-9)  # snapped to 1/630,000
    inside = barycentric(vertices[tets[0]], fine.vertices[fine.tets.ravel()])
    assert inside.min() > -1e-3


def barycentric(tet, points):
    columns = np.concatenate([tet.T, np.ones((1, 4))])
    return np.linalg.solve(columns, np.concatenate([points.T, np.ones((1, len(points)))])).T


def test_children_stand_at_8i_to_8i_plus_7(lr):
    for coarse, fine in zip(lr.levels[:-1], lr.levels[1:], strict=True):
        np.testing.assert_allclose(fine.volumes.reshape(-1, 8).sum(axis=1), coarse.volumes, rtol=1e-12)
        np.testing.assert_allclose(
            fine.centroids.reshape(-1, 8, 3).mean(axis=1), coarse.centroids, atol=1e-12
        )
        # Old vertices keep their place and their index.
        np.testing.assert_array_equal(fine.vertices[: len(coarse.vertices)], coarse.vertices)


def test_the_split_is_along_a_shortest_diagonal(lr):
    for coarse, fine in zip(lr.levels[:2], lr.levels[1:3], strict=True):
        corners = coarse.vertices[coarse.tets]
        middle = {
            pair: corners[:, list(pair)].mean(axis=1)
            for pair in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
        }
        diagonals = np.stack(
            [
                np.linalg.norm(middle[0, k] - middle[tuple(sorted({1, 2, 3} - {k}))], axis=1)
                for k in (1, 2, 3)
            ],
            axis=1,
        )
        ends = fine.vertices[fine.tets.reshape(-1, 8, 4)[:, 4, :2]]
        used = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
        np.testing.assert_allclose(used, diagonals.min(axis=1), rtol=1e-12)


def test_a_tie_does_not_see_the_order_of_a_tets_vertices():
    base = cube_lattice(2).grid
    turned = TetGrid(base.vertices, base.tets[:, [1, 2, 0, 3]])
    plain, other = (subdivide_hierarchy(grid, 2).finest for grid in (base, turned))
    assert {frozenset(tet) for tet in plain.tets.tolist()} == {frozenset(tet) for tet in other.tets.tolist()}


def test_half_of_the_octahedra_are_ties():
    # Why the rule matters: a regular lattice leaves the choice to it half of the time.
    lattice = cube_lattice(2)
    midpoints = lattice.points[lattice.tets][:, EDGES].sum(axis=2)
    lengths = ((midpoints[:, :3] - midpoints[:, :2:-1]) ** 2).sum(axis=-1)  # edges k and 5 - k are opposite
    ties = (lengths == lengths.min(axis=1, keepdims=True)).sum(axis=1) > 1
    assert 0.3 < ties.mean() < 0.7


@pytest.mark.parametrize("cells", range(1, 11))
def test_snapping_leaves_lattices_alone(cells):
    assert subdivide_hierarchy(cube_lattice(cells).grid, 1).digest == build_hierarchy(cells, 1).digest


def test_a_grid_outside_the_cube_is_refused():
    base = cube_lattice(1).grid
    with pytest.raises(ValueError, match="outside the unit cube"):
        subdivide_hierarchy(TetGrid(base.vertices + 0.1, base.tets), 1)


def test_upsampling_weights_agree_with_a_loop():
    coarse, fine = build_hierarchy(1, 2).levels[1:]
    weights = upsampling_weights(coarse, fine)
    assert weights.shape == (192, 8, 5)
    for parent in range(0, 192, 17):
        for child in range(8):
            expected = np.zeros(5)
            for column, source in enumerate([parent, *coarse.neighbors[parent]]):
                if source >= 0:
                    gap = coarse.centroids[source] - fine.centroids[8 * parent + child]
                    expected[column] = 1 / np.linalg.norm(gap)
            np.testing.assert_allclose(weights[parent, child], expected / expected.sum(), rtol=1e-12)


def test_upsampling_keeps_a_constant(lr):
    weights = upsampling_weights(lr.levels[1], lr.levels[2])
    np.testing.assert_allclose(weights.sum(axis=2), 1, rtol=1e-12)
    assert weights.min() >= 0


@pytest.mark.parametrize(("cells", "limit"), [(2, 1.0), (3, 3.0)])
def test_the_papers_grids_build_fast(cells, limit):
    start = time.process_time()  # CPU time, which a busy machine does not stretch
    for grid in build_hierarchy(cells, 3).levels:
        assert len(grid.neighbors) == len(grid.tets)
    assert time.process_time() - start < limit
