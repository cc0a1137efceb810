"""The three kinds of step: the networks that each moves, and the direction."""

import copy

import pytest
import torch

from tetgan.fields.field import vertex_operator
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.training.average import WeightAverage
from tetgan.training.loop import step_draws

HIERARCHY = build_hierarchy(1, 1)
MODEL = {"grid": "smoke", "width": 4, "code": 6, "local_critic_width": 2, "global_critic_width": 4}


def learner(model=None, **training) -> TetganLearner:
    options = TetganTraining.parse({"learning_rate": 1e-2, "critic_learning_rate": 1e-2} | training)
    operator = vertex_operator(HIERARCHY.finest)
    chosen = TetganOptions.parse(MODEL | (model or {}))
    return TetganLearner(chosen, options, HIERARCHY, operator, mu=0.02, seed=0, device=torch.device("cpu"))


@pytest.fixture
def field() -> torch.Tensor:
    field = torch.rand(4, len(HIERARCHY.finest.tets), 4, generator=torch.Generator().manual_seed(0))
    field[..., 0] = (field[..., 0] > 0.7).float()
    return field


def snapshot(module) -> list[torch.Tensor]:
    return [p.detach().clone() for p in module.parameters()]


def moved(module, before) -> list[bool]:
    return [not torch.equal(p, old) for p, old in zip(module.parameters(), before, strict=True)]


def test_an_autoencoder_step_moves_both_halves_and_no_critic(field):
    subject = learner()
    generator, critics = snapshot(subject.generator), snapshot(subject.critics)
    losses = subject.autoencoder_step(field, 0.1, step_draws(0, 0))
    assert all(moved(subject.generator, generator))
    assert not any(moved(subject.critics, critics))
    assert losses.keys() == {"occupancy_loss", "displacement_loss", "kl"}


def test_a_critic_step_moves_critics_alone(field):
    subject = learner()
    generator, critics = snapshot(subject.generator), snapshot(subject.critics)
    subject.critic_step(field, step_draws(0, 0))
    assert not any(moved(subject.generator, generator))
    assert any(moved(subject.critics["local"], critics[: len(list(subject.critics["local"].parameters()))]))


def test_critics_compare_real_and_fake_fields_in_the_same_units(field):
    """Probabilities and displacements in units of the range, written out from the draws of the step."""
    subject = learner(model={"displacement_range": 0.2}, gradient_penalty=7.0)
    draws = step_draws(0, 0)
    codes = torch.randn(4, *subject.generator.latent_shape, generator=draws)
    share = torch.rand(4, generator=draws).view(4, 1, 1)
    decoded = subject.generator.decode(codes).detach()
    fake = torch.cat([decoded[..., :1].sigmoid(), decoded[..., 1:] / 0.2], dim=-1)
    real = torch.cat([field[..., :1], (field[..., 1:] / 0.2).clamp(-1, 1)], dim=-1)
    between = (share * real + (1 - share) * fake).requires_grad_()
    expected, total = {}, torch.zeros(())
    for name, critic in subject.critics.items():
        gap = (critic(real) - critic(fake)).mean()
        (slope,) = torch.autograd.grad(critic(between).sum(), between, create_graph=True)
        penalty = (slope.flatten(1).norm(dim=1) - 1).square().mean()
        expected |= {f"{name}_gap": gap.item(), f"{name}_penalty": penalty.item()}
        total = total - gap + 7 * penalty
    gradient = flat(torch.autograd.grad(total, list(subject.critics.parameters()), materialize_grads=True))
    losses = subject.critic_step(field, step_draws(0, 0))
    assert {name: float(value) for name, value in losses.items()} == pytest.approx(expected, rel=1e-4)
    got = flat(torch.zeros_like(p) if p.grad is None else p.grad for p in subject.critics.parameters())
    torch.testing.assert_close(got, gradient, rtol=1e-3, atol=1e-5 * float(gradient.abs().max()))


def test_a_late_critic_learns_at_its_full_rate(field):
    early, late = learner(), learner()
    late.set_rate(0.01)
    for subject in (early, late):
        subject.critic_step(field, step_draws(0, 0))
        subject.autoencoder_step(field, 0.1, step_draws(0, 0))
    assert not any(moved(late.critics, snapshot(early.critics)))
    assert all(moved(late.generator, snapshot(early.generator)))


def test_an_adversarial_step_moves_the_decoder_alone():
    subject = learner()
    encoder, critics = snapshot(subject.generator.encoder), snapshot(subject.critics)
    decoder = snapshot(subject.generator.decoder)
    subject.adversarial_step(4, step_draws(0, 0))
    assert all(moved(subject.generator.decoder, decoder))
    assert not any(moved(subject.generator.encoder, encoder) + moved(subject.critics, critics))
    assert all(p.requires_grad for p in subject.critics.parameters())


def flat(tensors) -> torch.Tensor:
    return torch.cat([tensor.detach().flatten() for tensor in tensors])


def weights(subject: TetganLearner) -> torch.Tensor:
    return flat(subject.generator.parameters())


def adversarial_gradient(subject: TetganLearner, draws: torch.Generator) -> tuple[torch.Tensor, ...]:
    """Of the weighted scores of four decoded draws, written out; zero where a weight is not in it."""
    codes = torch.randn(4, *subject.generator.latent_shape, generator=draws)
    decoded = subject.generator.decode(codes)
    fake = torch.cat([decoded[..., :1].sigmoid(), decoded[..., 1:]], dim=-1)
    loss = -sum(
        getattr(subject.training, f"{name}_weight") * critic(fake).mean()
        for name, critic in subject.critics.items()
    )
    return torch.autograd.grad(loss, list(subject.generator.parameters()), materialize_grads=True)


def cosine(first: torch.Tensor, second: torch.Tensor) -> float:
    return float(torch.cosine_similarity(first, second, dim=0))


@pytest.mark.parametrize("betas", [(0.0, 0.9), (0.5, 0.99)])
def test_adversarial_steps_follow_the_adversarial_gradient(field, betas):
    """Between autoencoder steps of large momentum they are those of an Adam that sees nothing else.

    Compared as updates, because Adam divides each element of a gradient by its usual size.
    """
    subject = learner(betas=(0.9, 0.99), adversarial_betas=betas, learning_rate=1e-3)
    alone = [torch.zeros_like(p, requires_grad=True) for p in subject.generator.parameters()]
    reference = torch.optim.Adam(alone, 1e-3, betas=betas)
    for turn in range(3):
        for step in range(5):
            subject.autoencoder_step(field, 0.1, step_draws(turn, step))
        subject.critic_step(field, step_draws(turn, 8))
        gradients = adversarial_gradient(subject, step_draws(turn, 9))
        for parameter, gradient in zip(alone, gradients, strict=True):
            parameter.grad = gradient
        before, reference_before = weights(subject), flat(alone)
        subject.adversarial_step(4, step_draws(turn, 9))
        reference.step()
        moved_by = weights(subject) - before
        assert cosine(moved_by, flat(alone) - reference_before) > 0.99
        momentum = [subject.optimizer.state[p]["exp_avg"] for p in subject.generator.parameters()]
        assert abs(cosine(moved_by, flat(momentum))) < 0.3


@pytest.mark.parametrize(("rate", "expected"), [(None, 1e-2), (1e-3, 1e-3)])
def test_both_optimisers_of_the_generator_follow_the_schedule(rate, expected):
    sizes = []
    for factor in (1.0, 0.01):
        subject = learner(adversarial_learning_rate=rate)
        subject.set_rate(factor)
        before = weights(subject)
        subject.adversarial_step(4, step_draws(0, 0))
        sizes.append(float((weights(subject) - before).abs().max()))
    # A first step of Adam is as long as the rate in each element, up to the rounding of the weights.
    assert sizes == pytest.approx([expected, expected / 100], rel=2e-2)


def test_the_ratio_is_that_of_the_decoder_s_gradients(field):
    subject = learner()
    own = [*subject.generator.head.expand.parameters(), *subject.generator.decoder.parameters()]

    def norm() -> float:
        return float(flat(p.grad for p in own).norm())

    assert "adversarial_ratio" not in subject.adversarial_step(4, step_draws(0, 0))
    subject.autoencoder_step(field, 0.1, step_draws(0, 1))
    autoencoder = norm()
    losses = subject.adversarial_step(4, step_draws(0, 2))
    assert float(losses["adversarial_ratio"]) == pytest.approx(norm() / autoencoder, rel=1e-5)


def test_critics_learn_to_score_real_fields_higher(field):
    subject = learner(gradient_penalty=1.0)
    gaps = [subject.critic_step(field, step_draws(0, step)) for step in range(30)]
    for name in ("local_gap", "global_gap"):
        assert gaps[-1][name] > gaps[0][name]
        assert gaps[-1][name] > 0


@pytest.mark.parametrize("name", ["local", "global"])
def test_the_decoder_learns_to_raise_each_score(field, name):
    # The official code has the wrong sign here.
    weights = {"local_weight": 0.0, "global_weight": 0.0} | {f"{name}_weight": 1.0}
    subject = learner(**weights, learning_rate=1e-3)
    for step in range(5):
        subject.critic_step(field, step_draws(0, step))
    assert list(subject.critics) == [name]
    losses = [subject.adversarial_step(4, step_draws(1, 0))["adversarial_loss"] for _ in range(10)]
    assert losses[-1] < losses[0]


@pytest.mark.parametrize("name", ["local", "global"])
def test_a_negative_weight_lowers_the_score(field, name):
    """As in the official code, whose global critic has the wrong sign; the critic itself learns as always."""
    weights = {"local_weight": 0.0, "global_weight": 0.0} | {f"{name}_weight": -1.0}
    subject = learner(**weights, learning_rate=1e-3)
    for step in range(5):
        subject.critic_step(field, step_draws(0, step))
    assert list(subject.critics) == [name]
    scores = [subject.adversarial_step(4, step_draws(1, 0))["adversarial_loss"] for _ in range(10)]
    assert scores[-1] < scores[0]  # a loss of -(-1) score


def test_after_the_bypass_codes_hold_the_features(field):
    """Four shapes have three components, which fit into a code of six, so nothing is lost in the head."""
    subject = learner(ema=0.9)
    subject.bypass_step(field, step_draws(0, 0))
    subject.start_head(iter([field[:1], field[1:]]))
    generator = subject.generator
    with torch.no_grad():
        expected = generator.decode_features(generator.features(field))
        torch.testing.assert_close(generator.decode(generator.encode(field)), expected, rtol=0, atol=1e-3)
        with subject.average.applied():  # it starts again from the new head
            torch.testing.assert_close(generator.decode(generator.encode(field)), expected, rtol=0, atol=1e-3)


def test_the_prior_is_fitted_to_all_posteriors(field):
    subject = learner(model={"prior": "fitted"})
    with torch.no_grad():
        mean, log_variance = subject.generator.posterior(field)
    subject.fit_prior(iter([field[:1], field[1:]]))
    prior = subject.generator.prior
    torch.testing.assert_close(prior.mean, mean.mean(dim=0), rtol=1e-4, atol=1e-5)
    torch.testing.assert_close(prior.noise.square(), log_variance.exp().mean(dim=0), rtol=1e-4, atol=1e-5)


def test_without_displacement_nothing_but_occupancy_is_learned(field):
    subject = learner(model={"displacement": False})
    generator = snapshot(subject.generator)
    losses = subject.autoencoder_step(field, 0.1, step_draws(0, 0))
    assert all(moved(subject.generator, generator))
    assert losses["displacement_loss"] == 0
    losses = subject.critic_step(field, step_draws(0, 0))
    assert losses.keys() == {"local_gap", "local_penalty", "global_gap", "global_penalty"}


def test_shared_convolutions_train_like_others(field):
    subject = learner(model={"convolution": "shared"})
    generator, critics = snapshot(subject.generator), snapshot(subject.critics)
    subject.autoencoder_step(field, 0.1, step_draws(0, 0))
    subject.critic_step(field, step_draws(0, 0))
    assert all(moved(subject.generator, generator))
    assert any(moved(subject.critics, critics))


def test_parts_hold_all_that_further_steps_depend_on(field):
    def train(subject: TetganLearner, first: int) -> None:
        subject.autoencoder_step(field, 0.1, step_draws(0, first))
        subject.critic_step(field, step_draws(0, first + 1))
        subject.adversarial_step(4, step_draws(0, first + 2))

    stopped, resumed = learner(), learner()
    train(stopped, 0)
    for name, part in resumed.parts().items():
        part.load_state_dict(copy.deepcopy(stopped.parts()[name].state_dict()))
    for subject in (stopped, resumed):
        train(subject, 3)
    assert torch.equal(weights(stopped), weights(resumed))
    assert not any(moved(stopped.critics, snapshot(resumed.critics)))


def test_without_critics_there_is_one_optimiser():
    assert learner(adversarial_start=1).parts().keys() == {"generator", "optimizer", "average"}


def test_the_average_follows_the_weights():
    module = torch.nn.Linear(1, 1, bias=False)
    average = WeightAverage(module, 0.5)
    start = module.weight.item()
    with torch.no_grad():
        module.weight.add_(1)
    average.update()  # early: keeps min(0.5, 2 / 11)
    with average.applied():
        assert module.weight.item() == pytest.approx(start + 9 / 11)
    assert module.weight.item() == pytest.approx(start + 1)


def test_draws_depend_on_seed_and_step():
    draws = [torch.rand(1, generator=step_draws(*key)).item() for key in ((0, 0), (0, 1), (1, 0), (0, 0))]
    assert draws[0] == draws[3]
    assert len(set(draws)) == 3
