"""Instance normalisation and the activation behind it, in one step."""

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.autograd.function import once_differentiable
from torch.nn import functional

SLOPE = 0.2


class TetInstanceNorm(nn.Module):
    """Each channel of each shape to mean 0 and variance 1 over the tets, then leaky ReLU of slope 0.2.

    No learned scale, eps 1e-5. The two are one function because apart they would keep twice the
    memory and, being bound by it, take twice the time. Features may be in half precision; what is summed over
    tets is summed in single precision.
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
        y = x - _mean(x)
        # Centred first: a mean of squares minus a squared mean loses all digits where the mean is large.
        scale = torch.rsqrt(_mean(y.square()) + eps)
        y = functional.leaky_relu_(y.mul_(scale), SLOPE).to(x.dtype)
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
        normal, grad = _normal(y), _through_activation(grad, y)
        along = scale * _mean(grad * normal) + scale.square() * grad_scale / len(y)
        return torch.addcmul(scale * (grad - _mean(grad)), normal, along, value=-1).to(y.dtype)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, v: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:  # type: ignore[override]
        """By g: the same projection of v. By y: −r (q v + p h) / leaky', p = mean(v x̂), q = mean(h x̂)."""
        grad, y, scale = ctx.saved_tensors
        normal, grad = _normal(y), _through_activation(grad, y)
        p, q, mean = _mean(v * normal), _mean(grad * normal), _mean(v)
        by_scale = len(y) * (_mean(v * grad) - mean * _mean(grad) - p * q)
        by_grad = torch.addcmul(scale * (v - mean), normal, scale * p, value=-1)
        by_normal = torch.addcmul((scale * q).neg() * v, grad, scale * p, value=-1)
        by_y = torch.ops.aten.leaky_relu_backward(by_normal, y, 1 / SLOPE, True)
        return _through_activation(by_grad, y).to(y.dtype), by_y.to(y.dtype), by_scale, -scale.square() * p


def _normal(y: Tensor) -> Tensor:
    """What the activation was applied to."""
    return functional.leaky_relu(y, 1 / SLOPE)


def _through_activation(grad: Tensor, y: Tensor) -> Tensor:
    return torch.ops.aten.leaky_relu_backward(grad, y, SLOPE, True)


def _mean(x: Tensor) -> Float[Tensor, "B C"]:
    """Over tets, in single precision at least."""
    return x.mean(dim=0, dtype=torch.promote_types(x.dtype, torch.float32))
