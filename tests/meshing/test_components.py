"""Floating pieces and voids."""

import numpy as np
import pytest

from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.collared_grid import collared_grid
from tetgan.meshing.components import count_cavities, drop_small_pieces
from tetgan.meshing.occupancy import valid_solid
from tetgan.meshing.options import MeshingOptions


@pytest.fixture(scope="module")
def balls():
    """A large ball and a small one apart from it, as occupancies of a grid of 9,216 tets."""
    grid = build_hierarchy(2, 2).finest
    large = np.linalg.norm(grid.centroids - 0.4, axis=1) < 0.3
    small = np.linalg.norm(grid.centroids - 0.85, axis=1) < 0.1
    return grid, large, small


@pytest.mark.parametrize("joined_by", ["faces", "vertices"])
def test_only_pieces_below_the_least_volume_go(balls, joined_by):
    grid, large, small = balls
    ambient, volume = collared_grid(grid), grid.volumes[small].sum()
    both = ambient.with_collar(large | small)
    kept = drop_small_pieces(both, ambient, volume * (1 - 1e-9), joined_by=joined_by)
    np.testing.assert_array_equal(kept.occupancy, both)
    left = drop_small_pieces(both, ambient, volume * (1 + 1e-9), joined_by=joined_by)
    np.testing.assert_array_equal(left.occupancy, ambient.with_collar(large))
    assert left.volumes == pytest.approx([volume])


def test_the_largest_piece_stays_in_any_case(balls):
    grid, large, small = balls
    ambient = collared_grid(grid)
    left = drop_small_pieces(ambient.with_collar(large | small), ambient, 1.0, joined_by="faces").occupancy
    np.testing.assert_array_equal(left, ambient.with_collar(large))


def test_voids_are_counted_and_what_is_open_is_none(balls):
    grid, large, small = balls
    ambient = collared_grid(grid)
    full = np.ones(len(grid.tets), dtype=bool)
    assert count_cavities(ambient.with_collar(full), ambient) == 0
    assert count_cavities(ambient.with_collar(~small & ~large), ambient) == 2
    shaft = (np.abs(grid.centroids[:, :2] - 0.4) < 0.15).all(axis=1)
    assert count_cavities(ambient.with_collar(~small & ~large & ~shaft), ambient) == 1


def test_the_record_adds_up(balls):
    grid, large, small = balls
    rng = np.random.default_rng(0)
    occupancy = (large | small) ^ (rng.random(len(large)) < 0.01)
    options = MeshingOptions(min_component=0.05)
    cost = np.ones(len(occupancy))
    solid, changes = valid_solid(occupancy, cost, grid, options)
    valid = solid.occupancy[: len(occupancy)]
    assert changes.changed == pytest.approx((changes.tets_added + changes.tets_removed) / occupancy.sum())
    dropped = sum(changes.dropped)
    assert dropped * grid.volumes[occupancy].sum() > 0.9 * grid.volumes[small].sum()
    lost = dropped * grid.volumes[occupancy].sum() / grid.volumes.min()
    assert abs(int(valid.sum()) - int(occupancy.sum())) <= lost + changes.tets_added + changes.tets_removed
