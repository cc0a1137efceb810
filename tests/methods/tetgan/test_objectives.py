"""Losses and schedules by hand."""

import math

import numpy as np
import pytest
import torch
from scipy import sparse

from tetgan.methods.tetgan.objectives import (
    as_seen_by_critics,
    displacement_loss,
    occupancy_loss,
    relative_displacement_loss,
)
from tetgan.methods.tetgan.options import TetganTraining
from tetgan.methods.tetgan.schedule import adversarial_step_due, kl_weight, rate_factor
from tetgan.nn.rows import RowMap
from tetgan.training.losses import gradient_penalty, kl_divergence


def options(**values) -> TetganTraining:
    return TetganTraining.parse(values)


def test_occupied_tets_count_as_often_as_told():
    decoded, field = torch.zeros(1, 4, 4), torch.zeros(1, 4, 4)
    field[0, 0, 0] = 1
    # A logit of 0 costs log 2 a tet: three empty ones and one that counts three times.
    assert occupancy_loss(decoded, field, 3.0).item() == pytest.approx(6 / 4 * math.log(2))


def test_displacements_are_compared_at_vertices():
    # One vertex that averages two tets, another that sees the second alone.
    vertices = RowMap(sparse.csr_array(np.array([[0.5, 0.5], [0.0, 1.0]])))
    decoded, field = torch.zeros(1, 2, 4), torch.zeros(1, 2, 4)
    decoded[0, 0, 1], decoded[0, 1, 1] = 1, -1
    # Errors 0 and -1 in x, none in y and z.
    assert displacement_loss(decoded, field, vertices).item() == pytest.approx(1 / 6)


def test_relative_displacement_loss_by_hand():
    vertices = RowMap(sparse.csr_array(np.array([[0.5, 0.5], [0.0, 1.0]])))
    decoded, field = torch.zeros(1, 2, 4), torch.zeros(1, 2, 4)
    field[0, 0, 1:], field[0, 1, 1:] = torch.tensor([0.4, 0, 0]), torch.tensor([0.2, 0.4, 0])
    decoded[0, 1, 1:] = torch.tensor([0.2, 0, 0.3])
    # Vertices: true (0.3, 0.2, 0) and (0.2, 0.4, 0), errors (-0.2, -0.2, 0.15) and (0, -0.4, 0.3).
    by_hand = (0.1025 / (0.13 + 0.04) + 0.25 / (0.20 + 0.04)) / 2
    assert relative_displacement_loss(decoded, field, vertices, 0.1).item() == pytest.approx(by_hand)


def test_kl_of_known_normals():
    assert kl_divergence(torch.zeros(2, 3), torch.zeros(2, 3)).item() == 0
    # KL(N(1, 4) ‖ N(0, 1)) = (1 + 4 - 1 - log 4) / 2
    got = kl_divergence(torch.ones(1, 1), torch.full((1, 1), math.log(4)))
    assert got.item() == pytest.approx((4 - math.log(4)) / 2)


def test_critics_see_probabilities():
    seen = as_seen_by_critics(torch.tensor([[[0.0, 0.1, 0.2, 0.3]]]))
    torch.testing.assert_close(seen, torch.tensor([[[0.5, 0.1, 0.2, 0.3]]]))


def test_penalty_of_a_linear_critic():
    # The gradient of 2 x₀ is 2 wherever it is taken: (2 - 1)² = 1.
    critic = lambda field: 2 * field[:, 0, 0]  # noqa: E731
    got = gradient_penalty(critic, torch.rand(3, 5, 4), torch.rand(3, 5, 4), torch.rand(3))
    assert got.item() == pytest.approx(1.0)


def test_kl_weight_rises_like_the_paper_s():
    paper = options()
    assert kl_weight(0, paper) == pytest.approx(0.01)
    assert kl_weight(5648 * 100, paper) == pytest.approx(1 - 0.99 * 0.9935**100)
    assert kl_weight(1, options(kl_weight=0.5, kl_decay=0)) == pytest.approx(0.5)


def test_rates():
    cosine = options(decay="cosine")
    assert [rate_factor(p, cosine) for p in (0.0, 0.5, 1.0)] == pytest.approx([1.0, 0.505, 0.01])
    assert rate_factor(0.7, options()) == 1.0


def test_when_critics_train():
    chosen = options(adversarial_start=0.5, adversarial_every=3)
    assert [step for step in range(12) if adversarial_step_due(step, 12, chosen)] == [6, 9]
    late = options(head_start=0.75, adversarial_every=3)
    assert [step for step in range(12) if adversarial_step_due(step, 12, late)] == [9]
    assert not adversarial_step_due(0, 12, options(local_weight=0, global_weight=0))
    assert adversarial_step_due(0, 12, options(local_weight=0, global_weight=-0.01))
    assert not adversarial_step_due(11, 12, options(adversarial_start=1))
