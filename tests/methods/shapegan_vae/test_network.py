"""ShapeGAN's autoencoder: its size by the sum over its layers, shapes and units."""

import pytest
import torch

from tetgan.methods.shapegan_vae.network import ShapeGanVae
from tetgan.methods.shapegan_vae.options import ShapeGanVaeOptions


@pytest.fixture(scope="module")
def model() -> ShapeGanVae:
    torch.manual_seed(0)
    return ShapeGanVae(ShapeGanVaeOptions(kind="shapegan-vae")).eval()


def linear(inputs: int, outputs: int) -> int:
    return inputs * outputs + outputs


def convolution(channels: int, out: int) -> int:
    return channels * out * 4**3 + out


def norm(channels: int) -> int:
    return 2 * channels


def test_has_the_parameters_of_its_layers(model):
    encoder = convolution(1, 24) + convolution(24, 48) + convolution(48, 96) + convolution(96, 256)
    encoder += norm(24) + norm(48) + norm(96) + norm(256) + linear(256, 128) + norm(128)
    heads = 2 * linear(128, 128)
    decoder = linear(128, 256) + norm(256)
    decoder += convolution(256, 96) + convolution(96, 48) + convolution(48, 24) + convolution(24, 1)
    decoder += norm(96) + norm(48) + norm(24)
    assert (encoder, heads, decoder) == (1_977_464, 33_024, 1_977_081)
    assert sum(p.numel() for p in model.parameters()) == encoder + heads + decoder == 3_987_569


def test_encodes_and_decodes_cubes_of_32(model):
    voxels = torch.rand(3, 32, 32, 32) - 0.5
    latent = model.encode(voxels)
    assert latent.shape == (3, *model.latent_shape) == (3, 128)
    assert model.voxels(latent).shape == voxels.shape
    assert model.has_encoder


def test_the_networks_see_units_of_the_clamp(model):
    voxels = torch.rand(1, 32, 32, 32) - 0.5
    torch.testing.assert_close(model.encode(0.1 * voxels), model.posterior(voxels)[0])
    latent = torch.randn(1, 128)
    torch.testing.assert_close(model.voxels(latent), 0.1 * model.decode(latent))


def test_evaluated_shapes_do_not_depend_on_each_other(model):
    latent = torch.randn(3, 128)
    torch.testing.assert_close(model.voxels(latent)[1:2], model.voxels(latent[1:2]), rtol=1e-4, atol=1e-6)
