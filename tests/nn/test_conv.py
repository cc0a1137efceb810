"""The convolution against a loop over tets, and its derivatives against finite differences."""

from contextlib import nullcontext

import numpy as np
import pytest
import torch

from tetgan.grids.hierarchy import build_hierarchy
from tetgan.nn.conv import SLOTS, TetConv, TetNeighbors, input_gradients_only, tet_conv

WIDTHS = [
    (4, 12),
    (12, 12),
    (12, 16),
    (12, 3),
    (3, 3),
    (16, 1),
]  # every branch: thin, even, wide on either side


@pytest.fixture(scope="module")
def neighbors() -> np.ndarray:
    return build_hierarchy(1, 1).finest.neighbors


@pytest.fixture(scope="module")
def few() -> np.ndarray:
    return build_hierarchy(1, 0).finest.neighbors


def convolve_slowly(x, weight, bias, neighbors):
    y = x @ weight[0] + bias
    for tet, row in enumerate(neighbors):
        for slot, other in enumerate(row):
            if other >= 0:
                y[tet] += x[other] @ weight[slot + 1]
    return y


def draw(*shape, requires_grad=False):
    generator = torch.Generator().manual_seed(sum(shape))
    return torch.randn(*shape, generator=generator, dtype=torch.float64).requires_grad_(requires_grad)


@pytest.mark.parametrize(("channels", "out"), WIDTHS)
def test_agrees_with_a_loop_over_tets(neighbors, channels, out):
    x, weight, bias = draw(len(neighbors), 2, channels), draw(SLOTS, channels, out), draw(out)
    got = tet_conv(x, weight, bias, TetNeighbors(neighbors))
    torch.testing.assert_close(got, convolve_slowly(x, weight, bias, neighbors), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("channels", "out"), [(2, 10), (2, 2), (10, 2), (9, 9)])
def test_first_and_second_derivatives(few, channels, out):
    maps = TetNeighbors(few)
    inputs = (
        draw(len(few), 1, channels, requires_grad=True),
        draw(SLOTS, channels, out, requires_grad=True),
        draw(out, requires_grad=True),
    )
    assert torch.autograd.gradcheck(lambda *a: tet_conv(*a, maps), inputs, fast_mode=True)
    assert torch.autograd.gradgradcheck(lambda *a: tet_conv(*a, maps), inputs, fast_mode=True)


def test_adjoint_is_the_transpose(neighbors):
    # <g, conv(x)> = <conv*(g), x> for all x and g.
    conv = TetConv(12, 12, TetNeighbors(neighbors)).double()
    x, g = draw(len(neighbors), 3, 12, requires_grad=True), draw(len(neighbors), 3, 12)
    linear = conv(x) - conv.bias
    (back,) = torch.autograd.grad(linear, x, g)
    torch.testing.assert_close((linear * g).sum(), (back * x).sum(), rtol=1e-12, atol=0)


def test_shapes_of_a_batch_do_not_mix(neighbors):
    conv = TetConv(9, 9, TetNeighbors(neighbors)).double()
    x = draw(len(neighbors), 3, 9)
    torch.testing.assert_close(conv(x)[:, 1:2], conv(x[:, 1:2].contiguous()), rtol=1e-12, atol=1e-12)


def test_a_penalty_on_input_gradients_reaches_the_weights(neighbors):
    # d/dW |dL/dx|² is the same with and without the shortcut.
    x, penalties = draw(len(neighbors), 1, 9, requires_grad=True), []
    conv = TetConv(9, 9, TetNeighbors(neighbors)).double()
    for context in (nullcontext(), input_gradients_only()):
        with context:
            (dx,) = torch.autograd.grad(conv(x).square().sum(), x, create_graph=True)
        penalties.append(torch.autograd.grad(dx.square().sum(), conv.weight)[0])
    torch.testing.assert_close(*penalties)
    assert penalties[0].abs().sum() > 0


def test_gradients_of_the_weights_are_left_out_until_the_outer_block_ends(few):
    x, weight = draw(len(few), 1, 2, requires_grad=True), draw(SLOTS, 2, 3, requires_grad=True)

    def of_weight():
        y = tet_conv(x, weight, None, TetNeighbors(few)).sum()
        return torch.autograd.grad(y, (x, weight), allow_unused=True)[1]

    with input_gradients_only():
        with input_gradients_only():
            pass
        assert of_weight() is None
    assert of_weight() is not None


@pytest.mark.parametrize(("channels", "out"), WIDTHS)
def test_unordered_neighbors_share_a_matrix(neighbors, channels, out):
    conv = TetConv(channels, out, TetNeighbors(neighbors, ordered=False)).double()
    assert sum(p.numel() for p in conv.parameters()) == 2 * channels * out + out
    tied = torch.stack([conv.weight[0], *4 * [conv.weight[1]]])
    x = draw(len(neighbors), 2, channels)
    ordered = tet_conv(x, tied, conv.bias, TetNeighbors(neighbors))
    torch.testing.assert_close(conv(x), ordered, rtol=0, atol=0)


def test_unordered_neighbors_may_change_places(neighbors):
    x, elsewhere = draw(len(neighbors), 1, 9), neighbors[:, [2, 0, 3, 1]]
    for ordered in (False, True):
        conv = TetConv(9, 9, TetNeighbors(neighbors, ordered=ordered)).double()
        turned = TetConv(9, 9, TetNeighbors(elsewhere, ordered=ordered)).double()
        turned.load_state_dict(conv.state_dict())
        assert torch.allclose(conv(x), turned(x), rtol=1e-12, atol=1e-12) != ordered


@pytest.mark.parametrize(("channels", "out"), [(2, 10), (10, 2), (9, 9)])
def test_derivatives_of_a_shared_matrix(few, channels, out):
    conv = TetConv(channels, out, TetNeighbors(few, ordered=False)).double()
    inputs = draw(len(few), 1, channels, requires_grad=True), draw(2, channels, out, requires_grad=True)

    def convolve(x, weight):
        return torch.func.functional_call(conv, {"weight": weight}, (x,))

    assert torch.autograd.gradcheck(convolve, inputs, fast_mode=True)
    assert torch.autograd.gradgradcheck(convolve, inputs, fast_mode=True)


def test_half_precision_under_autocast(neighbors):
    conv = TetConv(12, 12, TetNeighbors(neighbors))
    x = draw(len(neighbors), 2, 12).float()
    with torch.autocast("cpu", torch.bfloat16):
        half = conv(x)
    assert half.dtype == torch.bfloat16
    # bfloat16 has 8 bits; sums of 60 products of size about 0.1
    torch.testing.assert_close(half.float(), conv(x), rtol=0.05, atol=0.05)
