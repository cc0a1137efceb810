"""Losses and schedules by hand."""

import math

import numpy as np
import pytest
import torch
from scipy import sparse

from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.methods.tetgan.objectives import (
    Objectives,
    as_seen_by_critics,
    displacement_loss,
    occupancy_loss,
    relative_displacement_loss,
)
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
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


def test_the_penalty_is_taken_at_the_share_of_the_real():
    # The gradient of x² / 2 is x: at 0.25 · 4 + 0.75 · 0 = 1 it is as long as it should be, at 0.5 it is not.
    critic = lambda field: field.square().flatten(1).sum(dim=1) / 2  # noqa: E731
    real, fake = torch.zeros(2, 1, 4), torch.zeros(2, 1, 4)
    real[:, 0, 2] = 4
    assert gradient_penalty(critic, real, fake, torch.tensor([0.25, 0.5])).item() == pytest.approx(
        (0 + 1) / 2
    )


class Weighted(torch.nn.Module):
    """A critic whose score is a weighted sum of the first tet's channels."""

    def __init__(self, *weights: float) -> None:
        super().__init__()
        self.weights = torch.tensor(weights)

    def forward(self, field):
        return field[:, 0] @ self.weights


LOCAL, GLOBAL = Weighted(2.0, 1.0, 0.0, 2.0), Weighted(0.0, 0.0, 4.0, 0.0)

DECODED = torch.tensor([[[2.5, 0.25, 0.1, 0.0], [0.0, 0.0, 0.0, 0.0]]])
"""Two tets: logit, then displacement in units of the largest."""

FIELD = torch.tensor([[[1.0, 0.0, 0.1, 0.0], [0.0, 0.6, 0.0, 0.0]]])


@pytest.fixture
def decoded_from():
    """The codes that were decoded."""
    return []


def objectives(decoded_from: list[torch.Tensor], **training) -> Objectives:
    """Of a network with displacement range ½ whose posterior and decoding are known.

    One vertex averages both tets, another sees the second alone; μ is 0.05 of the largest displacement.
    """
    model = TetganOptions.parse({"grid": "two", "width": 1, "code": 2, "displacement_range": 0.5})
    generator = TetganGenerator(model, build_hierarchy(1, 1))
    mean, log_variance = torch.tensor([[0.5, -1.0]]), torch.tensor([[4.0, 9.0]]).log()
    generator.posterior = lambda _: (mean, log_variance)
    generator.decode = lambda latent: decoded_from.append(latent) or DECODED
    generator.features = lambda _: mean[None]
    generator.decode_features = generator.decode
    vertices = RowMap(sparse.csr_array(np.array([[0.5, 0.5], [0.0, 1.0]])))
    critics = torch.nn.ModuleDict({"local": LOCAL, "global": GLOBAL})
    return Objectives(generator, critics, vertices, options(**training), 0.05)


OCCUPANCY = (3 * math.log1p(math.exp(-2.5)) + math.log(2)) / 2  # the occupied tet counts three times
# In units of the range the errors are 0.5 and -1 in x (0.6 is clipped to ½): at the vertices -0.25 and -1.
SQUARED = (0.25**2 + 1) / 6
# |D|² at the vertices is 0.5² + 0.1² and 1; μ is 0.1, so (2 μ)² is 0.04.
RELATIVE = (0.25**2 / (0.26 + 0.04) + 1 / (1 + 0.04)) / 2
KL = ((0.25 + 4 - 1 - math.log(4)) + (1 + 9 - 1 - math.log(9))) / 4


@pytest.mark.parametrize(("kind", "displacement"), [("squared", SQUARED), ("relative", RELATIVE)], ids=str)
def test_the_autoencoder_s_objective(decoded_from, kind, displacement):
    subject = objectives(
        decoded_from, positive_weight=3.0, displacement_weight=5.0, displacement_loss=kind, kl_weight=1.0
    )
    loss, parts = subject("autoencoder", FIELD, torch.tensor([[1.0, 2.0]]), 0.3)
    # Mean plus deviation times noise: 0.5 + 2 · 1 and -1 + 3 · 2.
    torch.testing.assert_close(decoded_from[0], torch.tensor([[2.5, 5.0]]))
    assert loss.item() == pytest.approx(OCCUPANCY + 5 * displacement + 0.3 * KL, rel=1e-6)
    assert {name: value.item() for name, value in parts.items()} == pytest.approx(
        {"occupancy_loss": OCCUPANCY, "displacement_loss": displacement, "kl": KL}, rel=1e-6
    )


def test_the_bypass_decodes_features_with_noise_and_has_no_kl(decoded_from):
    subject = objectives(decoded_from, positive_weight=3.0, displacement_weight=5.0)
    loss, parts = subject("bypass", FIELD, torch.tensor([[[1.0, 2.0]]]))
    torch.testing.assert_close(decoded_from[0], torch.tensor([[[1.5, 1.0]]]))
    assert loss.item() == pytest.approx(OCCUPANCY + 5 * SQUARED, rel=1e-6)
    assert parts.keys() == {"occupancy_loss", "displacement_loss"}


def test_a_critic_s_gap(decoded_from):
    real, fake = torch.zeros(3, 1, 4), torch.zeros(3, 1, 4)
    real[:, 0, 0], fake[:, 0, 3] = torch.tensor([1.0, 0.0, 0.5]), torch.tensor([0.25, 1.0, 1.0])
    # Scores of the local critic: 2, 0 and 1 of the real ones, 0.5, 2 and 2 of the fakes.
    loss, parts = objectives(decoded_from)("gap", "local", real, fake)
    assert (loss.item(), parts["local_gap"].item()) == pytest.approx((0.5, -0.5))


def test_a_critic_s_penalty(decoded_from):
    # The local critic's gradient is (2, 1, 0, 2), of length 3; the global one's is 4 long.
    subject = objectives(decoded_from, gradient_penalty=7.0)
    for name, penalty in (("local", 4.0), ("global", 9.0)):
        loss, parts = subject("penalty", name, torch.rand(2, 1, 4), torch.rand(2, 1, 4), torch.rand(2))
        assert parts[f"{name}_penalty"].item() == pytest.approx(penalty, rel=1e-6)
        assert loss.item() == pytest.approx(7 * penalty, rel=1e-6)


def test_the_adversarial_objective(decoded_from):
    subject = objectives(decoded_from, local_weight=0.5, global_weight=-3.0)
    loss, parts = subject("adversarial", torch.tensor([[0.5, 0.25]]))
    torch.testing.assert_close(decoded_from[0], torch.tensor([[0.5, 0.25]]))
    # A probability, and a displacement in units of the range: 0.25 / ½ and 0.1 / ½.
    local, whole = 2 / (1 + math.exp(-2.5)) + 0.5, 4 * 0.2
    assert loss.item() == pytest.approx(-0.5 * local + 3 * whole, rel=1e-6)
    assert parts["adversarial_loss"].item() == loss.item()


def test_the_defaults_are_the_paper_s():
    paper = options()
    assert (paper.gradient_penalty, paper.critic_steps, paper.batch_size) == (10, 3, 30)
    assert paper.learning_rate == paper.critic_learning_rate == 1e-4
    assert paper.betas == paper.adversarial_betas == (0, 0.9)
    assert (paper.displacement_loss, paper.displacement_weight, paper.kl_weight) == ("squared", 1, 1)


def test_kl_weight_rises_like_the_paper_s():
    paper = options()
    assert kl_weight(0, paper) == pytest.approx(0.01)
    assert kl_weight(5648 * 100, paper) == pytest.approx(1 - 0.99 * 0.9935**100)
    assert kl_weight(1, options(kl_weight=0.5, kl_decay=0)) == pytest.approx(0.5)


def test_rates():
    assert [rate_factor(p, "cosine") for p in (0.0, 0.5, 1.0)] == pytest.approx([1.0, 0.505, 0.01])
    assert rate_factor(0.7, "constant") == 1.0


def test_when_critics_train():
    chosen = options(adversarial_start=0.5, adversarial_every=3)
    assert [step for step in range(12) if adversarial_step_due(step, 12, chosen)] == [6, 9]
    late = options(head_start=0.75, adversarial_every=3)
    assert [step for step in range(12) if adversarial_step_due(step, 12, late)] == [9]
    assert not adversarial_step_due(0, 12, options(local_weight=0, global_weight=0))
    assert adversarial_step_due(0, 12, options(local_weight=0, global_weight=-0.01))
    assert not adversarial_step_due(11, 12, options(adversarial_start=1))
