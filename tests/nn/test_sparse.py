"""Layers on active sets: a loop as oracle, gradients, and the dense layer where all tets are active."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.grids.active import active_levels, adjacencies
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.nn.conv import TetNeighbors, tet_conv
from tetgan.nn.sparse import ActiveConv, ActiveNeighbors, ActivePool, ActiveUpsample, active_conv

HIERARCHY = build_hierarchy(1, 1)
AROUND = adjacencies(HIERARCHY)


def finest(seed: int, share: float):
    """Active tets of the finest level, as an `ActiveLevel` and as tensors."""
    near = np.random.default_rng(seed).random(len(HIERARCHY.finest.tets)) < share
    level = active_levels(AROUND, near)[-1]
    return level, ActiveNeighbors.of_table(torch.from_numpy(level.neighbors), torch.from_numpy(level.back))


def numbers(*shape: int, seed: int = 0) -> torch.Tensor:
    return torch.randn(shape, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)


@settings(deadline=None)  # the first product of matrices loads a library
@given(seed=st.integers(0, 1000), share=st.sampled_from([0.01, 0.05]))
def test_a_loop_over_tets_gives_the_same(seed, share):
    level, neighbors = finest(seed, share)
    x, weight, bias = numbers(len(level.cells), 3), numbers(5, 3, 2, seed=1), numbers(2, seed=2)
    expected = torch.empty(len(level.cells), 2, dtype=torch.float64)
    for tet, others in enumerate(level.neighbors.tolist()):
        expected[tet] = bias + x[tet] @ weight[0]
        for slot, other in enumerate(others, start=1):
            if other >= 0:
                expected[tet] += x[other] @ weight[slot]
    torch.testing.assert_close(active_conv(x, weight, bias, neighbors), expected)


def test_gradients_are_those_of_finite_differences():
    level, neighbors = finest(0, 0.01)
    assert (level.neighbors < 0).any() and (level.neighbors >= 0).any()
    x, weight, bias = numbers(len(level.cells), 2), numbers(5, 2, 3, seed=1), numbers(3, seed=2)
    inputs = [value.requires_grad_() for value in (x, weight, bias)]
    assert torch.autograd.gradcheck(lambda *values: active_conv(*values, neighbors), inputs)


def test_with_all_tets_active_it_is_the_dense_convolution():
    _, neighbors = finest(0, 1.0)
    tets = len(HIERARCHY.finest.tets)
    x, weight, bias = numbers(tets, 4).float(), numbers(5, 4, 6, seed=1).float(), numbers(6, seed=2).float()
    inputs = [value.requires_grad_() for value in (x, weight, bias)]
    dense = tet_conv(x[:, None], weight, bias, TetNeighbors(HIERARCHY.finest.neighbors))[:, 0]
    sparse = active_conv(x, weight, bias, neighbors)
    torch.testing.assert_close(sparse, dense)
    grad = numbers(tets, 6, seed=3).float()
    pairs = (torch.autograd.grad(y, inputs, grad) for y in (sparse, dense))
    for mine, theirs in zip(*pairs, strict=True):
        torch.testing.assert_close(mine, theirs, rtol=1e-4, atol=1e-4)


def test_features_that_need_no_gradient_get_none():
    level, neighbors = finest(0, 0.05)
    layer = ActiveConv(2, 3)
    layer(torch.randn(len(level.cells), 2), neighbors).sum().backward()
    assert layer.bias.grad.tolist() == [len(level.cells)] * 3


def test_the_gain_scales_the_start():
    torch.manual_seed(0)
    full = ActiveConv(4, 4)
    torch.manual_seed(0)
    torch.testing.assert_close(ActiveConv(4, 4, gain=0.1).weight, 0.1 * full.weight)


@pytest.mark.parametrize("parents", [1, 3])
def test_eight_children_side_by_side_and_back(parents):
    pool, upsample = ActivePool(2, 3), ActiveUpsample(3, 2)
    x = torch.randn(8 * parents, 2)
    pooled, spread = pool(x), upsample(torch.randn(parents, 3))
    assert pooled.shape == (parents, 3) and spread.shape == (8 * parents, 2)
    by_hand = pool.bias + sum(x[child] @ pool.weight.T[2 * child : 2 * child + 2] for child in range(8))
    torch.testing.assert_close(pooled[0], by_hand)


def test_each_child_has_a_matrix_of_its_own():
    upsample, x = ActiveUpsample(3, 2), torch.randn(2, 3)
    matrices, biases = upsample.weight.view(8, 2, 3), upsample.bias.view(8, 2)
    torch.testing.assert_close(upsample(x)[8 + 5], matrices[5] @ x[1] + biases[5])


def test_under_autocast_it_computes_in_half_precision():
    _, neighbors = finest(0, 0.05)
    x, layer = numbers(len(neighbors.rows), 4).float(), ActiveConv(4, 3)
    exact = layer(x, neighbors)
    with torch.autocast("cpu", dtype=torch.bfloat16):
        rounded = layer(x, neighbors)
    rounded.float().sum().backward()
    assert rounded.dtype == torch.bfloat16 and layer.weight.grad.dtype == torch.float32
    torch.testing.assert_close(rounded.float(), exact, rtol=0.03, atol=0.03)  # eight binary places
