"""Instance normalisation and the activation behind it, in one step."""

from collections.abc import Callable
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.autograd.function import once_differentiable
from torch.nn import functional

SLOPE = 0.2
CPU_CHUNK, GPU_CHUNK = 2**17, 2**24  # numbers


class TetInstanceNorm(nn.Module):
    """Each channel of each shape to mean 0 and variance 1 over the tets, then leaky ReLU of slope 0.2.

    No learned scale, eps 1e-5. The two are one function because apart they would keep twice the
    memory and, being bound by it, take twice the time. Features may be in half precision; everything
    inside is in single precision.
    """

    def __init__(self, eps: float = 1e-5) -> None:
        super().__init__()
        self.eps = eps

    def forward(self, x: Float[Tensor, "T B C"]) -> Float[Tensor, "T B C"]:
        return _NormActivate.apply(x, self.eps)[0]


class _NormActivate(torch.autograd.Function):
    """y = leaky(x̂), x̂ = (x − mean) r, r = 1/√(var + eps); r is an output so that it has a gradient too.

    y and r tell all that the backward pass needs; x is not kept.
    """

    @staticmethod
    def forward(ctx: Any, x: Tensor, eps: float) -> tuple[Tensor, Tensor]:
        mean, variance = _mean_and_variance(x)
        scale = torch.rsqrt(variance + eps)
        y = torch.empty_like(x)
        for rows in _chunks(x):
            normal = (x[rows] - mean).mul_(scale)
            y[rows] = functional.leaky_relu_(normal, SLOPE)
        ctx.save_for_backward(y, scale)
        return y, scale

    @staticmethod
    def backward(ctx: Any, grad: Tensor, grad_scale: Tensor) -> tuple[Tensor, None]:  # type: ignore[override]
        return _Gradient.apply(grad, *ctx.saved_tensors, grad_scale), None


class _Gradient(torch.autograd.Function):
    """r (h − mean(h) − x̂ mean(h x̂)) with h = g leaky'(x̂), less x̂ r² / T for each unit of r's own gradient.

    Its derivative is written out: as plain operations it would keep three tensors of this size in place of
    one, and in a gradient penalty these are what fills the memory.
    """

    @staticmethod
    def forward(ctx: Any, grad: Tensor, y: Tensor, scale: Tensor, grad_scale: Tensor) -> Tensor:
        ctx.save_for_backward(grad, y, scale)
        grad_mean, along = _means(lambda h, normal: (h, h * normal), grad, y)
        along = scale * along + scale.square() * grad_scale / len(y)
        out = torch.empty_like(y)
        for rows in _chunks(y):
            h, normal = _inside(grad[rows], y[rows])
            out[rows] = (h - grad_mean).mul_(scale).addcmul_(normal, along, value=-1)
        return out

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, v: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:  # type: ignore[override]
        """By g: the same projection of v. By y: −r (q v + p h) / leaky', p = mean(v x̂), q = mean(h x̂)."""
        grad, y, scale = ctx.saved_tensors
        v_mean, p, grad_mean, q, both = _means(
            lambda h, normal, v: (v, v * normal, h, h * normal, v * h), grad, y, v
        )
        by_scale = len(y) * (both - v_mean * grad_mean - p * q)
        by_grad, by_y, p_scaled, q_scaled = torch.empty_like(y), torch.empty_like(y), scale * p, -scale * q
        for rows in _chunks(y):
            h, normal = _inside(grad[rows], y[rows])
            part = v[rows].to(scale.dtype)
            projected = (part - v_mean).mul_(scale).addcmul_(normal, p_scaled, value=-1)
            by_grad[rows] = _through_activation(projected, y[rows])
            by_normal = (part * q_scaled).addcmul_(h, p_scaled, value=-1)
            by_y[rows] = torch.ops.aten.leaky_relu_backward(by_normal, y[rows], 1 / SLOPE, True)
        return by_grad, by_y, by_scale, -scale.square() * p


def _inside(grad: Tensor, y: Tensor) -> tuple[Tensor, Tensor]:
    """The gradient in front of the activation, and what the activation was applied to; single precision."""
    exact = torch.promote_types(y.dtype, torch.float32)
    y = y.to(exact)
    return _through_activation(grad.to(exact), y), functional.leaky_relu(y, 1 / SLOPE)


def _through_activation(grad: Tensor, y: Tensor) -> Tensor:
    return torch.ops.aten.leaky_relu_backward(grad, y.to(grad.dtype), SLOPE, True)


def _mean_and_variance(x: Tensor) -> tuple[Tensor, Tensor]:
    """Over tets, from means and squares about them of each chunk (Chan, Golub and LeVeque 1979).

    A mean of squares less a squared mean would lose all digits where the mean is large.
    """
    chunks, means, squares = _chunks(x), [], []
    for rows in chunks:
        part = x[rows].to(torch.promote_types(x.dtype, torch.float32))
        means.append(part.mean(dim=0))
        squares.append((part - means[-1]).square_().sum(dim=0))
    each = torch.stack(means)
    share = each.new_full((len(chunks), 1, 1), len(x[chunks[0]]) / len(x))
    share[-1] = len(x[chunks[-1]]) / len(x)
    mean = (share * each).sum(dim=0)
    between = (share * (each - mean).square()).sum(dim=0)
    return mean, torch.stack(squares).sum(dim=0) / len(x) + between


def _means(
    terms: Callable[..., tuple[Tensor, ...]], grad: Tensor, y: Tensor, *further: Tensor
) -> list[Tensor]:
    """Means over tets of what `terms` makes of the gradient in front of the activation, x̂ and the rest."""
    sums: list[Tensor] = []
    for rows in _chunks(y):
        h, normal = _inside(grad[rows], y[rows])
        parts = terms(h, normal, *(values[rows].to(h.dtype) for values in further))
        found = [part.sum(dim=0) for part in parts]
        sums = [total + part for total, part in zip(sums, found, strict=True)] if sums else found
    return [total / len(y) for total in sums]


def _chunks(x: Tensor) -> list[slice]:
    """Tets to take at a time, so that what is made on the way fits a CPU's cache, or a corner of a GPU."""
    numbers = CPU_CHUNK if x.device.type == "cpu" else GPU_CHUNK
    size = max(1, numbers // max(1, x[0].numel()))
    return [slice(first, first + size) for first in range(0, len(x), size)]
