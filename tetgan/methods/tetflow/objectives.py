"""Losses of the autoencoder: splits and occupied shares, and at the finest level distance and normal."""

from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from tetgan.methods.tetflow.autoencoder import CLIP
from tetgan.methods.tetflow.network import SIGN
from tetgan.methods.tetflow.shapes import ActiveBatch, BatchLevel

TERMS = ("split_loss", "share_loss", "distance_loss", "sign_loss", "normal_loss")

SHARE_WEIGHT = 0.5

DISTANCE_WEIGHT, BEND = 2.0, 0.3  # of the Huber loss: squared up to the bend

NORMAL_WEIGHT = 0.5


def reconstruction_losses(
    outputs: Sequence[Float[Tensor, "_N _O"]], batch: ActiveBatch, split_weight: float
) -> dict[str, Float[Tensor, ""]]:
    """The terms by name, weighted; those of coarser levels are sums over levels."""
    coarser = [_coarser(*pair, split_weight) for pair in zip(outputs[:-1], batch.levels[:-1], strict=True)]
    zero = outputs[-1].new_zeros(())
    splits, shares = zip(*coarser, strict=True) if coarser else ((zero,), (zero,))
    finest = finest_losses(outputs[-1], batch.distance, batch.normal)
    return dict(zip(TERMS, (torch.stack(splits).sum(), torch.stack(shares).sum(), *finest), strict=True))


def _coarser(
    output: Float[Tensor, "N 2"], level: BatchLevel, split_weight: float
) -> tuple[Float[Tensor, ""], Float[Tensor, ""]]:
    """Cross-entropies of a level's splits and occupied shares."""
    weight = output.new_tensor(split_weight)
    entropy = functional.binary_cross_entropy_with_logits
    split = entropy(output[:, 1], level.split, pos_weight=weight)
    return split, SHARE_WEIGHT * entropy(output[:, 0], level.share)


def finest_losses(
    output: Float[Tensor, "N 4"], distance: Float[Tensor, "N"], normal: Float[Tensor, "N 3"]
) -> tuple[Float[Tensor, ""], Float[Tensor, ""], Float[Tensor, ""]]:
    """Distance, its sign, and normal; the first and the last count e^-|distance|, most at the surface.

    Distance and sign are one number, so that they cannot disagree.
    """
    weights = torch.exp(-distance.abs())
    weights = weights / weights.sum()
    found = output[:, 0]
    error = functional.smooth_l1_loss(found, distance.clamp(-CLIP, CLIP), beta=BEND, reduction="none")
    sign = functional.binary_cross_entropy_with_logits(-SIGN * found, (distance < 0).float())
    turned = 1 - functional.cosine_similarity(output[:, 1:], normal, dim=1)
    return DISTANCE_WEIGHT * (weights * error).sum(), sign, NORMAL_WEIGHT * (weights * turned).sum()
