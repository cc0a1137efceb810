"""What the networks are trained on (paper, section 3.2); means all, whatever the sizes."""

from collections.abc import Callable

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from tetgan.nn.conv import input_gradients_only
from tetgan.nn.rows import RowMap


def occupancy_loss(
    decoded: Float[Tensor, "B T 4"], field: Float[Tensor, "B T 4"], positive_weight: float
) -> Float[Tensor, ""]:
    """Binary cross-entropy; occupied tets count `positive_weight` times."""
    weight = decoded.new_full((), positive_weight)
    return functional.binary_cross_entropy_with_logits(decoded[..., 0], field[..., 0], pos_weight=weight)


def displacement_loss(
    decoded: Float[Tensor, "B T 4"], field: Float[Tensor, "B T 4"], vertices: RowMap
) -> Float[Tensor, ""]:
    """Squared error of the vertex displacements of Eq. 3, per coordinate, in units of the range.

    `vertices` averages tets to vertices; it is linear, so the two fields are averaged as one difference.
    """
    difference = (decoded[..., 1:] - field[..., 1:]).transpose(0, 1)
    return vertices(difference).square().mean()


def kl_divergence(mean: Float[Tensor, "B ..."], log_variance: Float[Tensor, "B ..."]) -> Float[Tensor, ""]:
    """KL(N(mean, variance) ‖ N(0, 1)), mean over the elements of the code."""
    return 0.5 * (mean.square() + log_variance.exp() - 1 - log_variance).mean()


def as_seen_by_critics(decoded: Float[Tensor, "B T 4"]) -> Float[Tensor, "B T 4"]:
    """Logits as probabilities, like the 0 and 1 of real fields."""
    return torch.cat([decoded[..., :1].sigmoid(), decoded[..., 1:]], dim=-1)


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
