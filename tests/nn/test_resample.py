"""Pooling and upsampling against hand-made answers."""

import numpy as np
import pytest
import torch

from tetgan.grids.hierarchy import build_hierarchy, upsampling_weights
from tetgan.nn.resample import TetPool, TetUpsample


@pytest.fixture(scope="module")
def hierarchy():
    return build_hierarchy(1, 2)


def draw(*shape):
    return torch.randn(*shape, generator=torch.Generator().manual_seed(0), dtype=torch.float64)


def test_pooling_takes_eight_consecutive_children():
    x = torch.arange(16.0).view(16, 1, 1)
    assert TetPool("max")(x).flatten().tolist() == [7, 15]
    assert TetPool("mean")(x).flatten().tolist() == [3.5, 11.5]


def test_copies_pool_back(hierarchy):
    x = draw(len(hierarchy.levels[1].tets), 2, 3)
    fine = TetUpsample(hierarchy.levels[1], hierarchy.finest, "copy")(x)
    assert torch.equal(TetPool("max")(fine), x)


def test_averages_agree_with_a_loop(hierarchy):
    coarse, fine = hierarchy.levels[0], hierarchy.levels[1]
    x = draw(len(coarse.tets), 2, 3)
    weights = upsampling_weights(coarse, fine)
    got = TetUpsample(coarse, fine)(x)
    for parent in range(len(coarse.tets)):
        sources = [parent, *coarse.neighbors[parent]]
        for child in range(8):
            expected = sum(w * x[s] for w, s in zip(weights[parent, child], sources, strict=True) if s >= 0)
            # The weights are kept in single precision.
            torch.testing.assert_close(got[8 * parent + child], expected, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("kind", ["inverse_distance", "copy"])
def test_constants_stay_constant_and_derivatives_hold(hierarchy, kind):
    up = TetUpsample(hierarchy.levels[0], hierarchy.levels[1], kind)
    ones = torch.ones(len(hierarchy.levels[0].tets), 1, 1, dtype=torch.float64)
    torch.testing.assert_close(up(ones), torch.ones(len(hierarchy.levels[1].tets), 1, 1, dtype=torch.float64))
    x = draw(len(ones), 1, 2).requires_grad_()
    assert torch.autograd.gradcheck(up, x, fast_mode=True)
    assert torch.autograd.gradgradcheck(up, x, fast_mode=True)


def test_pooled_maxima_have_second_derivatives():
    x = draw(16, 2, 2).requires_grad_()
    assert torch.autograd.gradgradcheck(lambda v: TetPool("max")(v).square(), x)


def test_missing_neighbors_get_no_weight(hierarchy):
    up = TetUpsample(hierarchy.levels[0], hierarchy.levels[1])
    rows = torch.diff(up.rows.product_starts)
    expected = (hierarchy.levels[0].neighbors >= 0).sum(axis=1) + 1
    assert np.array_equal(rows.numpy(), expected.repeat(8))
