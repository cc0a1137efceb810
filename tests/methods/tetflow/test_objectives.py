"""Losses of the autoencoder by hand."""

import math

import pytest
import torch

from tetgan.methods.tetflow.objectives import finest_losses, reconstruction_losses
from tetgan.methods.tetflow.shapes import ActiveBatch, BatchLevel

OUTWARD = torch.tensor([[0.0, 0, 1]])


def finest(found: list[float], distance: list[float], normals: torch.Tensor) -> list[float]:
    output = torch.cat([torch.tensor(found)[:, None], normals], dim=1)
    losses = finest_losses(output, torch.tensor(distance), OUTWARD.expand(len(found), 3))
    return [float(loss) for loss in losses]


def test_the_distance_s_huber_loss():
    # Off by 0.1, within the bend: 0.1² / (2 · 0.3); off by 1, beyond it: 1 - 0.3 / 2; each times 2.
    assert finest([0.1], [0.0], OUTWARD)[0] == pytest.approx(2 * 0.01 / 0.6)
    assert finest([1.0], [0.0], OUTWARD)[0] == pytest.approx(2 * 0.85)


def test_far_distances_are_clipped():
    assert finest([2.0], [7.0], OUTWARD)[0] == 0
    assert finest([-2.0], [-7.0], OUTWARD)[0] == 0


def test_the_weights_fall_away_from_the_surface():
    # Weights 1 and 1/e: the first is right, the second off by 1.
    distance, _, normal = finest([0.0, 2.0], [0.0, 1.0], torch.tensor([[0.0, 0, 2], [0.0, 3, 0]]))
    share = math.exp(-1) / (1 + math.exp(-1))
    assert distance == pytest.approx(2 * share * 0.85)
    # The length of a normal does not matter; a right angle costs 1, times a half.
    assert normal == pytest.approx(0.5 * share)


def test_the_sign_s_cross_entropy():
    # Logit -6 s: at s = 0.5 the odds of inside are e^-3. The mean has no weights.
    outside, inside = math.log(1 + math.exp(-3)), math.log(1 + math.exp(3))
    assert finest([0.5, 0.5], [1.0, -0.1], OUTWARD.expand(2, 3))[1] == pytest.approx((outside + inside) / 2)


def test_opposite_normals_cost_twice_a_right_angle():
    assert finest([0.0], [0.0], -OUTWARD)[2] == pytest.approx(1.0)


def level(share: list[float], split: list[float]) -> BatchLevel:
    return BatchLevel(None, torch.tensor(share), torch.tensor(split), None)


def test_splits_and_shares_of_coarser_levels():
    # Even odds everywhere: log 2 each, those of split tets times 2, and shares a half; two levels.
    batch = ActiveBatch(
        1,
        [level([0.25, 1.0], [1.0, 0.0]), level([0.5], [1.0]), level([0.0], [0.0])],
        torch.zeros(1),
        OUTWARD,
    )
    outputs = [torch.zeros(2, 2), torch.zeros(1, 2), torch.cat([torch.zeros(1, 1), OUTWARD], dim=1)]
    losses = reconstruction_losses(outputs, batch, 2.0)
    log2 = math.log(2)
    assert float(losses["split_loss"]) == pytest.approx((2 * log2 + log2) / 2 + 2 * log2)
    assert float(losses["share_loss"]) == pytest.approx(0.5 * 2 * log2)
    assert float(losses["distance_loss"]) == float(losses["normal_loss"]) == 0
    assert float(losses["sign_loss"]) == pytest.approx(log2)


def test_a_grid_that_was_never_subdivided_has_no_splits():
    batch = ActiveBatch(1, [level([0.0], [0.0])], torch.zeros(1), OUTWARD)
    losses = reconstruction_losses([torch.cat([torch.zeros(1, 1), OUTWARD], dim=1)], batch, 2.0)
    assert float(losses["split_loss"]) == float(losses["share_loss"]) == 0
