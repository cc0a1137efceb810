"""Instance normalisation with leaky ReLU against PyTorch's two, and its derivatives."""

import torch
from torch.nn import functional

from tetgan.nn import norm
from tetgan.nn.norm import TetInstanceNorm


def draw(*shape):
    return torch.randn(*shape, generator=torch.Generator().manual_seed(0), dtype=torch.float64)


def test_equals_the_two_functions_of_pytorch():
    x = 3 * draw(50, 2, 5) + 7
    expected = functional.leaky_relu(functional.instance_norm(x.permute(1, 2, 0), eps=1e-5), 0.2)
    torch.testing.assert_close(TetInstanceNorm()(x), expected.permute(2, 0, 1))


def test_first_and_second_derivatives():
    x = draw(12, 2, 3).requires_grad_()
    assert torch.autograd.gradcheck(TetInstanceNorm(), x)
    assert torch.autograd.gradgradcheck(TetInstanceNorm(), x)


def test_a_large_mean_costs_no_digits():
    # Single precision keeps 7 digits: variance 1 on a mean of 1,000 would be lost as E[x²] − E[x]².
    x = draw(1000, 1, 4)
    got = TetInstanceNorm()((x + 1000).float())
    torch.testing.assert_close(got.double(), TetInstanceNorm()(x), rtol=0, atol=5e-4)


def test_a_constant_channel_becomes_zero():
    # But for the rounding of 3 r, r = 316: single precision has 24 bits.
    constant = TetInstanceNorm()(torch.full((10, 1, 2), 3.0))
    torch.testing.assert_close(constant, torch.zeros(10, 1, 2), rtol=0, atol=2**-14)


def test_half_precision_features_are_summed_in_single_precision():
    # Sums of 4,096 numbers: eight bits of them would be off by far more than the rounding of features.
    x = (draw(4096, 1, 4) + 3).bfloat16().requires_grad_()
    exact = x.detach().double().requires_grad_()
    got, expected = TetInstanceNorm()(x), TetInstanceNorm()(exact)
    assert got.dtype == torch.bfloat16
    torch.testing.assert_close(got.double(), expected, rtol=2**-7, atol=2**-7)
    cotangent = draw(4096, 1, 4)
    (ours,) = torch.autograd.grad(got, x, cotangent.bfloat16())
    (theirs,) = torch.autograd.grad(expected, exact, cotangent)
    torch.testing.assert_close(ours.double(), theirs, rtol=0, atol=2**-5)


def test_the_second_derivative_keeps_one_tensor_more():
    """The incoming gradient; the rest is computed again. (The square at the end keeps what it is of.)"""
    kept = set()

    def note(tensor: torch.Tensor) -> torch.Tensor:
        if tensor.shape == x.shape:
            kept.add(tensor.untyped_storage().data_ptr())
        return tensor

    x = draw(40, 2, 3).requires_grad_()
    with torch.autograd.graph.saved_tensors_hooks(note, lambda tensor: tensor):
        y = TetInstanceNorm()(x)
        cotangent = draw(40, 2, 3).requires_grad_()
        (gradient,) = torch.autograd.grad(y, x, cotangent, create_graph=True)
        gradient.square().sum()
    assert kept == {t.untyped_storage().data_ptr() for t in (y, cotangent, gradient)}


def test_chunks_change_nothing_but_rounding(monkeypatch):
    x = (draw(50, 2, 5) + 3).requires_grad_()

    def derivatives():
        y = TetInstanceNorm()(x)
        (first,) = torch.autograd.grad(y.square().sum(), x, create_graph=True)
        return y, first, *torch.autograd.grad(first.square().sum(), x)

    whole = derivatives()
    monkeypatch.setattr(norm, "CPU_CHUNK", 70)  # seven tets at a time, and one in the end
    for cut, expected in zip(derivatives(), whole, strict=True):
        torch.testing.assert_close(cut, expected, rtol=1e-12, atol=1e-12)
