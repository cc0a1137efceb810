"""Instance normalisation fused with leaky ReLU."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.autograd.function import once_differentiable
from torch.nn import functional

SLOPE = 0.2

CPU_CHUNK, GPU_CHUNK = 2**17, 2**24  # numbers; on a CPU, of each thread


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
        # Rounding of x r is that of x itself, so taking the mean off afterwards costs no more digits.
        shift, y = -mean * scale, torch.empty_like(x)
        for part, out in _chunks([x], [y]):
            functional.leaky_relu_(torch.addcmul(shift, part, scale, out=out), SLOPE)
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
        # h x̂ is g y: the slope goes out of it.
        grad_mean, along = _means(lambda g, y: (_through_activation(g, y), g * y), grad, y)
        along = scale * along + scale.square() * grad_scale / len(y)
        shift, out = -scale * grad_mean, torch.empty_like(y)
        for g, part, part_out in _chunks([grad, y], [out]):
            h, normal = _through_activation(g, part), _before_activation(part)
            torch.addcmul(shift, h, scale, out=part_out).addcmul_(normal, along, value=-1)
        return out

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, v: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:  # type: ignore[override]
        """By g: the same projection of v. By y: −r (q v + p h) / leaky', p = mean(v x̂), q = mean(h x̂)."""
        grad, y, scale = ctx.saved_tensors
        v_mean, p, grad_mean, q, both = _means(_second_terms, v, grad, y)
        by_scale = len(y) * (both - v_mean * grad_mean - p * q)
        shift, p_scaled, q_scaled = -scale * v_mean, -scale * p, -scale * q
        by_grad, by_y = torch.empty_like(y), torch.empty_like(y)
        for u, g, part, grad_out, y_out in _chunks([v, grad, y], [by_grad, by_y]):
            projected = torch.addcmul(shift, u, scale).addcmul_(_before_activation(part), p_scaled)
            _through_activation(projected, part, out=grad_out)
            by_normal = (u * q_scaled).addcmul_(_through_activation(g, part), p_scaled)
            _through_activation(by_normal, part, 1 / SLOPE, out=y_out)
        return by_grad, by_y, by_scale, -scale.square() * p


def _second_terms(v: Tensor, grad: Tensor, y: Tensor) -> tuple[Tensor, ...]:
    h = _through_activation(grad, y)
    return v, v * _before_activation(y), h, grad * y, v * h


def _before_activation(y: Tensor) -> Tensor:
    """What leaky ReLU was applied to."""
    return functional.leaky_relu(y, 1 / SLOPE)


def _through_activation(grad: Tensor, y: Tensor, slope: float = SLOPE, out: Tensor | None = None) -> Tensor:
    """A gradient times the slope where y is negative."""
    if out is None:
        return torch.ops.aten.leaky_relu_backward(grad, y, slope, True)
    return torch.ops.aten.leaky_relu_backward(grad, y, slope, True, grad_input=out)


def _mean_and_variance(x: Tensor) -> tuple[Tensor, Tensor]:
    """Over tets, from means and squares about them of each chunk (Chan, Golub and LeVeque 1979).

    A mean of squares less a squared mean would lose all digits where the mean is large.
    """
    shares, means, squares = [], [], []
    for (part,) in _chunks([x]):
        shares.append(len(part) / len(x))
        means.append(part.mean(dim=0))
        squares.append((part - means[-1]).square_().sum(dim=0))
    each = torch.stack(means)
    share = each.new_tensor(shares)[:, None, None]
    mean = (share * each).sum(dim=0)
    between = (share * (each - mean).square()).sum(dim=0)
    return mean, torch.stack(squares).sum(dim=0) / len(x) + between


def _means(terms: Callable[..., tuple[Tensor, ...]], *tensors: Tensor) -> list[Tensor]:
    """Means over tets of what `terms` makes of the tensors."""
    sums: list[Tensor] = []
    for parts in _chunks(tensors):
        found = [term.sum(dim=0) for term in terms(*parts)]
        sums = [total + part for total, part in zip(sums, found, strict=True)] if sums else found
    return [total / len(tensors[0]) for total in sums]


def _chunks(read: Sequence[Tensor], written: Sequence[Tensor] = ()) -> Iterator[list[Tensor]]:
    """A few tets of each at a time: what is made on the way fits a CPU's caches, or a corner of a GPU.

    Half precision is read as single and written back after the loop's body.
    """
    x = read[0]
    exact = torch.promote_types(x.dtype, torch.float32)
    numbers = CPU_CHUNK * torch.get_num_threads() if x.device.type == "cpu" else GPU_CHUNK
    size = max(1, numbers // max(1, x[0].numel()))
    for parts in zip(*(tensor.split(size) for tensor in (*read, *written)), strict=True):
        inside = [part if part.dtype == exact else part.to(exact) for part in parts]
        yield inside
        for part, changed in zip(parts[len(read) :], inside[len(read) :], strict=True):
            if changed is not part:
                part.copy_(changed)
