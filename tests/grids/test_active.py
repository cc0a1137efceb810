"""Active sets against loops over tets."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tetgan.grids.active import active_levels, adjacencies, adjacency, children_of, tables_among
from tetgan.grids.hierarchy import build_hierarchy

HIERARCHY = build_hierarchy(1, 2)
AROUND = adjacencies(HIERARCHY)


def some_near(seed: int, share: float) -> np.ndarray:
    return np.random.default_rng(seed).random(len(HIERARCHY.finest.tets)) < share


@given(seed=st.integers(0, 1000), share=st.sampled_from([0.0, 0.002, 0.05, 1.0]))
def test_a_tet_is_split_if_one_inside_it_is_near(seed, share):
    near = some_near(seed, share)
    coarse, middle, fine = active_levels(AROUND, near)
    assert coarse.cells.tolist() == list(range(24))
    for level, below, inside in ((coarse, middle, 64), (middle, fine, 8)):
        expected = [bool(near[cell * inside : (cell + 1) * inside].any()) for cell in level.cells]
        assert level.split.tolist() == expected
        children = [8 * cell + child for cell in level.cells[level.split] for child in range(8)]
        assert below.cells.tolist() == children
        assert level.parents.tolist() == [place for place, split in enumerate(level.split) if split]
    assert not fine.split.any()
    assert set(np.flatnonzero(near)) <= set(fine.cells.tolist())


@given(seed=st.integers(0, 1000), share=st.sampled_from([0.002, 0.05]))
def test_neighbours_are_the_grid_s_where_both_are_active(seed, share):
    for grid, level in zip(HIERARCHY.levels, active_levels(AROUND, some_near(seed, share)), strict=True):
        place = {cell: number for number, cell in enumerate(level.cells.tolist())}
        for number, cell in enumerate(level.cells.tolist()):
            expected = [place.get(other, -1) for other in grid.neighbors[cell].tolist()]
            assert level.neighbors[number].tolist() == expected
            for slot, other in enumerate(expected):
                if other >= 0:
                    assert level.neighbors[other, level.back[number, slot]] == number


def test_everything_near_is_the_whole_hierarchy():
    for grid, level in zip(HIERARCHY.levels, active_levels(AROUND, some_near(0, 1.0)), strict=True):
        np.testing.assert_array_equal(level.cells, np.arange(len(grid.tets)))
        np.testing.assert_array_equal(level.neighbors, grid.neighbors)


def test_shapes_that_are_numbered_on_do_not_touch():
    around, tets = adjacency(HIERARCHY.levels[1]), len(HIERARCHY.levels[1].tets)
    rng = np.random.default_rng(0)
    parts = [np.flatnonzero(rng.random(tets) < 0.4) for _ in range(3)]
    together, _ = tables_among(around, np.concatenate([part + tets * k for k, part in enumerate(parts)]))
    first = 0
    for part in parts:
        alone, _ = tables_among(around, part)
        rows = together[first : first + len(part)]
        np.testing.assert_array_equal(np.where(rows < 0, -1, rows - first), alone)
        first += len(part)


@pytest.mark.parametrize("count", [0, 2])
def test_children_come_eight_in_a_row(count):
    assert children_of(np.arange(count)).tolist() == list(range(8 * count))
