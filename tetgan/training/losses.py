"""Losses that several methods share."""

from collections.abc import Callable

import torch
from jaxtyping import Float
from torch import Tensor

from tetgan.nn.conv import input_gradients_only


def kl_divergence(mean: Float[Tensor, "B ..."], log_variance: Float[Tensor, "B ..."]) -> Float[Tensor, ""]:
    """KL(N(mean, variance) ‖ N(0, 1)), mean over the elements of the code."""
    return 0.5 * (mean.square() + log_variance.exp() - 1 - log_variance).mean()


def gradient_penalty(
    critic: Callable[[Tensor], Tensor],
    real: Float[Tensor, "B *shape"],
    fake: Float[Tensor, "B *shape"],
    share: Float[Tensor, "B"],
) -> Float[Tensor, ""]:
    """(|∇ critic| − 1)² between real and fake ones (Gulrajani et al. 2017, eq. 3), `share` of each real."""
    share = share.view(-1, *(real.ndim - 1) * (1,))
    between = (share * real + (1 - share) * fake).requires_grad_()
    with input_gradients_only():
        (gradient,) = torch.autograd.grad(critic(between).sum(), between, create_graph=True)
    return (gradient.flatten(1).norm(dim=1) - 1).square().mean()
