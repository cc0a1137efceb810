"""ShapeGAN: sizes by the sum over the layers, and the growth of the critic."""

import pytest
import torch
from torch.nn import functional

from tetgan.methods.shapegan.network import ShapeGanGenerator, VoxelCritic, halve
from tetgan.methods.shapegan.options import ShapeGanOptions


@pytest.fixture(scope="module")
def generator() -> ShapeGanGenerator:
    torch.manual_seed(0)
    return ShapeGanGenerator(ShapeGanOptions(kind="shapegan-gan"))


@pytest.fixture(scope="module")
def critic() -> VoxelCritic:
    torch.manual_seed(0)
    return VoxelCritic()


def parameters(module: torch.nn.Module) -> int:
    return sum(p.numel() for p in module.parameters())


def linear(inputs: int, outputs: int) -> int:
    return inputs * outputs + outputs


def convolution(channels: int, out: int) -> int:
    return channels * out * 4**3 + out


def test_the_generator_has_the_parameters_of_its_layers(generator):
    # 131 → 256 × 4, then 387 → 256 × 3 → 1
    expected = (
        linear(131, 256) + 3 * linear(256, 256) + linear(387, 256) + 2 * linear(256, 256) + linear(256, 1)
    )
    assert expected == 33_792 + 3 * 65_792 + 99_328 + 2 * 65_792 + 257 == 462_337
    assert parameters(generator) == expected


def test_the_critic_has_the_parameters_of_its_layers(critic):
    convolutions = convolution(1, 32) + convolution(32, 64) + convolution(64, 128) + convolution(128, 256)
    assert convolutions == 2_080 + 131_136 + 524_416 + 2_097_408
    assert 256 * 4**3 == 16_384
    expected = convolutions + linear(16_384, 128) + linear(128, 1)
    assert expected == 4_852_449
    assert parameters(critic) == expected


def test_the_generator_is_the_perceptron_that_sees_its_input_twice(generator):
    latent, points = torch.randn(2, 128), torch.rand(2, 5, 3)
    inputs = torch.cat([2 * points - 1, latent[:, None].expand(-1, 5, -1)], dim=-1)
    x = torch.relu(generator.first(inputs))
    for layer in generator.early:
        x = torch.relu(layer(x))
    x = torch.relu(generator.again(torch.cat([x, inputs], dim=-1)))
    for layer in generator.late:
        x = torch.relu(layer(x))
    expected = torch.tanh(generator.distance(x))[..., 0]
    torch.testing.assert_close(generator.clamped_distance(latent, points), expected, rtol=1e-4, atol=1e-6)
    # Positive inside, in cube sides.
    torch.testing.assert_close(generator.value(latent, points), -0.1 * expected, rtol=1e-4, atol=1e-7)


def test_a_gan_has_no_encoder(generator):
    assert not generator.has_encoder
    assert generator.level == 0
    with pytest.raises(NotImplementedError):
        generator.encode(torch.zeros(1, 32, 32, 32))


@pytest.mark.parametrize("resolution", [8, 16, 32, 64])
def test_the_critic_scores_each_resolution(critic, resolution):
    assert critic(torch.randn(2, resolution, resolution, resolution)).shape == (2,)


@pytest.mark.parametrize("resolution", [16, 32])
def test_unfaded_the_critic_is_that_of_half_the_resolution(critic, resolution):
    voxels = torch.randn(2, resolution, resolution, resolution)
    torch.testing.assert_close(critic(voxels, 0.0), critic(halve(voxels)), rtol=1e-4, atol=1e-6)


def test_fully_faded_in_the_critic_goes_through_the_new_convolution(critic):
    voxels = torch.randn(2, 16, 16, 16)
    x = torch.cat([voxels[:, None], torch.zeros(2, 63, 16, 16, 16)], dim=1)  # the first of 64 channels
    for layer in critic.convolutions[2:]:
        x = functional.leaky_relu(layer(x), 0.2)
    expected = critic.score(functional.leaky_relu(critic.hidden(x.flatten(1)), 0.2))[:, 0]
    torch.testing.assert_close(critic(voxels, 1.0), expected, rtol=1e-4, atol=1e-6)
    assert not torch.allclose(critic(voxels, 1.0), critic(voxels, 0.0))


@pytest.mark.parametrize("fade", [0.0, 0.25])
def test_the_new_convolution_learns_as_much_as_it_is_faded_in(critic, fade):
    voxels, layer = torch.randn(2, 16, 16, 16), critic.convolutions[2]
    (gradient,) = torch.autograd.grad(critic(voxels, fade).sum(), layer.weight)
    assert (gradient.abs().sum() > 0) == (fade > 0)


def test_halving_takes_means_of_eight():
    voxels = torch.arange(64.0).view(1, 4, 4, 4)
    # The first block: 0 and 1 in each of the rows 0, 4, 16 and 20.
    assert halve(voxels)[0, 0, 0, 0] == (0 + 1 + 4 + 5 + 16 + 17 + 20 + 21) / 8
    torch.testing.assert_close(halve(voxels), functional.avg_pool3d(voxels[:, None], 2)[:, 0])
