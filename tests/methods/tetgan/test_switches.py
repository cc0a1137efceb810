"""Switches that save time or memory leave the losses as they are."""

import pytest
import torch
from torch import Tensor

from tetgan.fields.field import vertex_operator
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.training.loop import step_draws

HIERARCHY = build_hierarchy(1, 1)
OPERATOR = vertex_operator(HIERARCHY.finest)
MODEL = TetganOptions.parse(
    {"grid": "smoke", "width": 4, "code": 6, "local_critic_width": 2, "global_critic_width": 4}
)
Losses = dict[str, float]


def learner(**training) -> TetganLearner:
    options = TetganTraining.parse({"learning_rate": 1e-2, "gradient_clip": 1.0, "ema": 0.9} | training)
    return TetganLearner(MODEL, options, HIERARCHY, OPERATOR, mu=0.02, seed=0, device=torch.device("cpu"))


@pytest.fixture(scope="module")
def field() -> Tensor:
    field = torch.rand(5, len(HIERARCHY.finest.tets), 4, generator=torch.Generator().manual_seed(0))
    field[..., 0] = (field[..., 0] > 0.7).float()
    return field


def losses_of_a_round(subject: TetganLearner, field: Tensor) -> list[Losses]:
    """Every kind of step, in turn; what an earlier one did to the weights shows in the later losses."""
    steps = [
        subject.bypass_step(field, step_draws(0, 0)),
        subject.autoencoder_step(field, 0.1, step_draws(0, 1)),
        subject.critic_step(field, step_draws(0, 2)),
        subject.adversarial_step(5, step_draws(0, 3)),
        subject.critic_step(field, step_draws(0, 4)),
        subject.autoencoder_step(field, 0.1, step_draws(0, 5)),
    ]
    return [{name: float(value) for name, value in losses.items()} for losses in steps]


@pytest.fixture(scope="module")
def plain(field) -> list[Losses]:
    return losses_of_a_round(learner(), field)


def assert_same(got: list[Losses], expected: list[Losses], **tolerance: float) -> None:
    for ours, theirs in zip(got, expected, strict=True):
        assert ours == pytest.approx(theirs, **tolerance)


STEPS = {
    "bypass": lambda subject, field: subject.bypass_step(field, step_draws(0, 0)),
    "autoencoder": lambda subject, field: subject.autoencoder_step(field, 0.1, step_draws(0, 0)),
    "critic": lambda subject, field: subject.critic_step(field, step_draws(0, 0)),
    "adversarial": lambda subject, field: subject.adversarial_step(5, step_draws(0, 0)),
}


@pytest.mark.parametrize("parts", [2, 7])
@pytest.mark.parametrize("kind", STEPS)
def test_a_batch_in_parts_has_the_same_losses_and_gradients(field, kind, parts):
    """Five shapes in parts of different sizes, and in more parts than shapes; clipped in the end."""
    whole, cut = learner(), learner(accumulate=parts)
    losses, cut_losses = (STEPS[kind](subject, field) for subject in (whole, cut))
    assert {name: float(value) for name, value in cut_losses.items()} == pytest.approx(
        {name: float(value) for name, value in losses.items()}, rel=1e-5, abs=1e-6
    )
    for (name, parameter), other in zip(
        whole.objectives.named_parameters(), cut.objectives.parameters(), strict=True
    ):
        assert (parameter.grad is None) == (other.grad is None), name
        if parameter.grad is not None:
            # Sums in another order: 1e-7 of the largest terms, which cancel in part.
            torch.testing.assert_close(
                other.grad, parameter.grad, rtol=1e-3, atol=1e-5 * max(1.0, float(parameter.grad.abs().max()))
            )


def test_checkpointing_changes_nothing_at_all(field, plain):
    assert losses_of_a_round(learner(checkpointing=True), field) == plain


def test_checkpointing_keeps_less(field):
    kept = []
    for subject in (learner(), learner(checkpointing=True)):
        storages: dict[int, int] = {}

        def note(tensor: Tensor, storages=storages) -> Tensor:
            storages[tensor.untyped_storage().data_ptr()] = tensor.untyped_storage().nbytes()
            return tensor

        with torch.autograd.graph.saved_tensors_hooks(note, lambda tensor: tensor):
            subject.objectives("autoencoder", field, torch.zeros(5, *subject.generator.latent_shape), 0.1)
        kept.append(sum(storages.values()))
    assert kept[1] < 0.6 * kept[0]


def test_half_precision_stays_near(field, plain):
    # Eight bits: 0.4 % a rounding. The first losses only; later ones follow weights that differ.
    got = losses_of_a_round(learner(precision="bf16"), field)
    assert_same(got[:1], plain[:1], rel=0.02)


def test_the_penalty_is_in_single_precision(field):
    penalties = []
    for precision in ("fp32", "bf16"):
        objectives = learner(precision=precision).objectives
        arguments = "local", field, field.flip(0), torch.linspace(0, 1, 5)
        penalties.append(float(objectives("penalty", *arguments)[0].detach()))
    assert penalties[0] == penalties[1]


def test_no_gradient_is_computed_for_weights_that_stay(field):
    subject = learner()
    subject.autoencoder_step(field, 0.1, step_draws(0, 0))
    subject.adversarial_step(5, step_draws(0, 1))
    assert all(p.grad is None for p in subject.critics.parameters())
    assert all(p.grad is None for p in subject.generator.encoder.parameters())
