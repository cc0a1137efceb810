"""Instance normalisation and the activation behind it, in one step."""

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

SLOPE = 0.2


class TetInstanceNorm(nn.Module):
    """Each channel of each shape to mean 0 and variance 1 over the tets, then leaky ReLU of slope 0.2.

    No learned scale, eps 1e-5. The two are one function because apart they would keep twice the
    memory and, being bound by it, take twice the time.
    """

    def __init__(self, eps: float = 1e-5) -> None:
        super().__init__()
        self.eps = eps

    def forward(self, x: Float[Tensor, "T B C"]) -> Float[Tensor, "T B C"]:
        return _NormActivate.apply(x, self.eps)[0]


class _NormActivate(torch.autograd.Function):
    """y = leaky(x̂), x̂ = (x − mean) r, r = 1/√(var + eps); r is an output so that it has a gradient too.

    The backward pass is written in y and r with plain differentiable operations, so it has a derivative
    itself; x is not kept.
    """

    @staticmethod
    def forward(ctx: Any, x: Tensor, eps: float) -> tuple[Tensor, Tensor]:
        y = x - x.mean(dim=0)
        # Centred first: a mean of squares minus a squared mean loses all digits where the mean is large.
        scale = torch.rsqrt(y.square().mean(dim=0) + eps)
        y = functional.leaky_relu_(y.mul_(scale), SLOPE)
        ctx.save_for_backward(y, scale)
        return y, scale

    @staticmethod
    def backward(ctx: Any, grad: Tensor, grad_scale: Tensor) -> tuple[Tensor, None]:  # type: ignore[override]
        y, scale = ctx.saved_tensors
        normal = functional.leaky_relu(y, 1 / SLOPE)
        grad = torch.ops.aten.leaky_relu_backward(grad, y, SLOPE, True)
        along = scale * (grad * normal).mean(dim=0) + scale.square() * grad_scale / len(y)
        return torch.addcmul(scale * (grad - grad.mean(dim=0)), normal, along, value=-1), None
