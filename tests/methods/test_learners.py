"""Learners of the baselines: losses by hand, few shapes overfitted, and the networks that each step moves."""

import math

import numpy as np
import pytest
import torch

from tetgan.errors import UserError
from tetgan.methods.occnet.options import OccNetOptions, OccNetTraining
from tetgan.methods.occnet.training import OccNetLearner, bound
from tetgan.methods.shapegan.options import ShapeGanOptions, ShapeGanTraining
from tetgan.methods.shapegan.training import ShapeGanLearner, stage_at, stages
from tetgan.methods.shapegan_vae.options import ShapeGanVaeOptions, ShapeGanVaeTraining
from tetgan.methods.shapegan_vae.training import ShapeGanVaeLearner, weighted_difference
from tetgan.models.iou import occupancy_iou
from tetgan.training.loop import step_draws
from tetgan.training.losses import gradient_penalty

ALL = torch.arange(4)


def occnet(store, **training) -> OccNetLearner:
    options = OccNetTraining.parse({"device": "cpu"} | training)
    return OccNetLearner(OccNetOptions(kind="occnet"), options, store, 0)


def shapegan(store, **training) -> ShapeGanLearner:
    options = ShapeGanTraining.parse({"device": "cpu", "epochs": 1} | training)
    return ShapeGanLearner(ShapeGanOptions(kind="shapegan-gan"), options, store, 0)


def vae(store, **training) -> ShapeGanVaeLearner:
    options = ShapeGanVaeTraining.parse({"device": "cpu"} | training)
    return ShapeGanVaeLearner(ShapeGanVaeOptions(kind="shapegan-vae"), options, store, 0)


def test_occnet_s_bound_by_hand():
    # Two points at even odds: 2 log 2. KL(N(1, 4) ‖ N(0, 1)) = (1 + 4 - 1 - log 4) / 2, thrice.
    three = torch.ones(1, 3)
    entropy, kl = bound(torch.zeros(1, 2), torch.tensor([[0.0, 1.0]]), three, math.log(4) * three)
    assert entropy.item() == pytest.approx(2 * math.log(2))
    assert kl.item() == pytest.approx(1.5 * (4 - math.log(4)))


def test_occnet_overfits_four_shapes(points):
    # Without the noise of the posterior and its price: these take far longer to find a balance.
    subject = occnet(points, learning_rate=2e-3, points=256)
    subject.held_out, subject.generator.threshold = subject.data, 0.5
    for step in range(1, 401):
        if step == 200:
            subject.optimizer.param_groups[0]["lr"] = 5e-4
        data = subject.data.random(ALL, 256, step_draws(0, step), subject.device)
        mean, log_variance = subject.generator.posterior(data)
        loss, _ = bound(subject.generator.value(mean, data[..., :3]), data[..., 3], mean, log_variance)
        subject.optimizer.zero_grad()
        loss.backward()
        subject.optimizer.step()
        if step % 25 == 0 and step > 200 and subject.validate()["validation_accuracy"] >= 0.97:
            return
    pytest.fail(f"{subject.validate()} after {step} steps")


def test_occnet_s_steps_lower_its_bound_on_the_same_draws(points):
    subject = occnet(points, learning_rate=1e-3, points=128)
    losses = [subject.take_step(ALL, step, 0.0, step_draws(0, 0)) for step in range(25)]
    totals = [row["reconstruction_loss"] + row["kl"] for row in losses]
    assert totals[-1] < 0.9 * totals[0]
    assert losses[0].keys() == {"reconstruction_loss", "kl"}


def test_shapegan_s_autoencoder_reconstructs_spheres(voxels):
    spheres = voxels._replace(shapes={name: voxels.shapes[name] for name in ("ball-0", "ball-1")})
    data = torch.from_numpy(np.stack(list(spheres.shapes.values())))
    subject = vae(spheres, learning_rate=2e-3)
    for step in range(1, 121):
        subject.take_step(torch.arange(2).repeat(3), step, 0.0, step_draws(0, step))
        if step % 20 == 0 and (iou := reconstruction_iou(subject, data)) >= 0.9:
            return
    pytest.fail(f"IoU {iou:.3f} after {step} steps")


def reconstruction_iou(subject: ShapeGanVaeLearner, data: torch.Tensor) -> float:
    """In cube sides, as the pipeline asks for it."""
    subject.generator.eval()
    with torch.no_grad():
        decoded = subject.generator.voxels(subject.generator.encode(data))
    return float(occupancy_iou(*((part < 0).flatten(1).numpy() for part in (decoded, data))).mean())


def test_the_weighted_difference_by_hand():
    decoded, true = torch.zeros(1, 2, 2, 2), torch.full((1, 2, 2, 2), 0.5)
    true[0, 0, 0, 0] = -0.25
    assert weighted_difference(decoded, true, 32.0).item() == (7 * 0.5 + 32 * 0.25) / 8


def test_the_penalty_of_a_linear_critic_of_voxels():
    # The gradient of Σ w x is w everywhere: (|w| - 1)².
    weight = torch.randn(4, 4, 4)
    critic = lambda voxels: (weight * voxels).sum(dim=(1, 2, 3))  # noqa: E731
    real, fake = torch.rand(3, 4, 4, 4), torch.rand(3, 4, 4, 4)
    got = gradient_penalty(critic, real, fake, torch.rand(3))
    assert got.item() == pytest.approx((weight.norm().item() - 1) ** 2, rel=1e-5)


def moved(module, before) -> list[bool]:
    return [not torch.equal(p, old) for p, old in zip(module.parameters(), before, strict=True)]


def snapshot(module) -> list[torch.Tensor]:
    return [p.detach().clone() for p in module.parameters()]


def test_a_critic_step_moves_the_critic_alone(voxels):
    subject = shapegan(voxels)
    generator, critic = snapshot(subject.generator), snapshot(subject.critic)
    losses = subject.take_step(ALL, 0, 0.0, step_draws(0, 0))
    assert not any(moved(subject.generator, generator))
    # At 8³ the last convolution alone comes before the linear layers, whose last offset cancels in the gap.
    assert moved(subject.critic, critic) == [*(6 * [False]), *(5 * [True]), False]
    assert losses.keys() == {"gap", "penalty", "resolution", "fade"}


def test_every_fifth_step_the_generator_moves_too(voxels):
    subject = shapegan(voxels)
    generator = snapshot(subject.generator)
    losses = [subject.take_step(ALL, step, 0.0, step_draws(0, step)) for step in range(5)]
    assert ["adversarial_loss" in row for row in losses] == 4 * [False] + [True]
    assert all(moved(subject.generator, generator))
    assert all(p.requires_grad for p in subject.critic.parameters())


def test_the_critic_learns_to_score_real_voxels_higher(voxels):
    subject = shapegan(voxels, gradient_penalty=1.0)
    gaps = [subject.take_step(ALL, 0, 0.0, step_draws(0, step))["gap"] for step in range(30)]
    assert gaps[-1] > max(gaps[0], 0)


def test_the_generator_learns_to_raise_its_score(voxels):
    subject = shapegan(voxels)
    for step in range(5):
        subject.critic_step(subject.data.batch(ALL, subject.device, 8), 1.0, step_draws(0, step))
    losses = [subject.generator_step(4, 8, 1.0, step_draws(1, 0))["adversarial_loss"] for _ in range(10)]
    assert losses[-1] < losses[0]


def test_generated_voxels_are_the_generator_at_their_centres(voxels):
    subject = shapegan(voxels)
    fake = subject._fake(2, 8, step_draws(0, 0))
    latent = torch.randn(2, *subject.generator.latent_shape, generator=step_draws(0, 0))
    centre = torch.tensor([[[(1 + 0.5) / 8, (2 + 0.5) / 8, (3 + 0.5) / 8]]]).expand(2, -1, -1)
    torch.testing.assert_close(fake[:, 1, 2, 3], subject.generator.clamped_distance(latent, centre)[:, 0])


def test_stages_of_the_critic():
    assert stages(32, 250) == [(8, 250), (16, 250), (32, 250)]
    assert stages(64, [4, 3, 2, 1]) == [(8, 4), (16, 3), (32, 2), (64, 1)]
    with pytest.raises(UserError, match="2 numbers for resolutions"):
        stages(32, [1, 2])
    with pytest.raises(UserError, match="voxels of 48"):
        stages(48, 1)


def test_a_new_resolution_is_blended_in():
    plan = [(8, 2), (16, 4), (32, 1)]
    assert [stage_at(epoch, plan, 2.0) for epoch in (0.0, 1.5, 2.0, 3.0, 4.0, 5.5, 6.0, 6.5)] == [
        *((8, 1.0), (8, 1.0)),
        *((16, 0.0), (16, 0.5), (16, 1.0), (16, 1.0)),
        *((32, 0.0), (32, 0.25)),
    ]
    assert stage_at(2.0, plan, 0.0) == (16, 1.0)


def test_too_little_for_batch_norm_and_a_wrong_resolution_are_errors(voxels):
    with pytest.raises(UserError, match="two training shapes"):
        vae(voxels._replace(shapes={"ball-0": voxels.shapes["ball-0"]}))
    with pytest.raises(UserError, match="voxels of 16 a side"):
        vae(voxels._replace(shapes={"ball-0": voxels.shapes["ball-0"][::2, ::2, ::2]}))
