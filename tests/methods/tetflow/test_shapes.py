"""Active shapes of fields, one by one and in batches."""

import numpy as np
import pytest
import torch

from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.tetflow.shapes import ActiveSets, collate

CPU = torch.device("cpu")
HIERARCHY = build_hierarchy(1, 2)
SETS = ActiveSets(HIERARCHY, 1.2)


def ball(radius: float, centre: float = 0.5):
    """Occupancy and displacement at the centroids of the finest tets."""
    offset = HIERARCHY.finest.centroids - centre
    length = np.linalg.norm(offset, axis=1, keepdims=True)
    return length[:, 0] < radius, ((radius - length) * offset / length).astype(np.float32)


def test_the_reach_is_in_cube_roots_of_a_tet():
    assert SETS.reach == pytest.approx(1.2 / len(HIERARCHY.finest.tets) ** (1 / 3))


def test_a_ball_s_distances_and_normals():
    shape = SETS.shape(*ball(0.3))
    offset = HIERARCHY.finest.centroids[shape.levels[-1].cells] - 0.5
    length = np.linalg.norm(offset, axis=1)
    # Half precision has eleven binary places.
    np.testing.assert_allclose(shape.distance, (length - 0.3) / SETS.reach, rtol=2**-10, atol=1e-5)
    np.testing.assert_allclose(shape.normal, offset / length[:, None], atol=2**-10)


def test_active_are_those_within_reach_and_all_children_of_their_ancestors():
    occupancy, displacement = ball(0.3)
    shape = SETS.shape(occupancy, displacement)
    near = np.linalg.norm(displacement, axis=1) < SETS.reach
    families = np.unique(np.flatnonzero(near) // 8)
    assert shape.levels[-1].cells.tolist() == (8 * families[:, None] + np.arange(8)).ravel().tolist()


def test_shares_are_means_over_the_finest_tets_inside():
    occupancy, displacement = ball(0.3)
    shape = SETS.shape(occupancy, displacement)
    for level, share, inside in zip(shape.levels, shape.shares, (64, 8, 1), strict=True):
        expected = [occupancy[cell * inside : (cell + 1) * inside].mean() for cell in level.cells]
        assert share.tolist() == expected


def test_a_batch_is_its_shapes_one_after_the_other():
    shapes = [SETS.shape(*ball(radius)) for radius in (0.2, 0.35)]
    batch = collate(shapes, CPU)
    assert batch.shapes == 2 and len(batch.levels) == 3
    for number, level in enumerate(batch.levels):
        first, second = (shape.levels[number] for shape in shapes)
        count, both = len(first.cells), len(first.cells) + len(second.cells)
        rows = level.neighbors.rows.numpy()
        assert rows[:, 0].tolist() == list(range(both))
        around = np.where(rows[:, 1:] == both, -1, rows[:, 1:])
        np.testing.assert_array_equal(around[:count], first.neighbors)
        np.testing.assert_array_equal(around[count:] - count * (around[count:] >= 0), second.neighbors)
        np.testing.assert_array_equal(level.parents, [*first.parents, *(second.parents + count)])
        np.testing.assert_array_equal(level.split, [*first.split, *second.split])
    assert len(batch.distance) == len(batch.normal) == len(batch.levels[-1].share)


def test_a_place_in_back_is_the_tet_itself_seen_from_its_neighbour():
    neighbors = collate([SETS.shape(*ball(radius)) for radius in (0.2, 0.35)], CPU).levels[-1].neighbors
    around, count = neighbors.rows[:, 1:], len(neighbors.rows)
    there = around < count
    itself = torch.arange(count)[:, None].expand(-1, 4)
    assert torch.equal(around.flatten()[neighbors.back[there]], itself[there].to(around.dtype))
    assert (neighbors.back[~there] == 4 * count).all()


def test_the_digest_tells_shapes_apart():
    first, same, other = (SETS.shape(*ball(radius)).digest for radius in (0.3, 0.3, 0.31))
    assert first == same != other
