"""OccNet: its size by the sum over its layers, and what its parts compute by the definition."""

import math

import pytest
import torch

from tetgan.methods.occnet.network import OccNetGenerator
from tetgan.methods.occnet.options import OccNetOptions
from tetgan.models.sampling import draw_latents
from tetgan.nn.pointwise import joint_linear


def linear(inputs: int, outputs: int) -> int:
    return inputs * outputs + outputs


@pytest.fixture
def model() -> OccNetGenerator:
    torch.manual_seed(0)
    model = OccNetGenerator(OccNetOptions(kind="occnet"))
    for block in model.decoder.blocks:  # away from the identity they start as
        torch.nn.init.normal_(block.outer.weight, std=0.1)
    return model


def test_has_as_many_parameters_as_the_public_code(model):
    encoder = linear(1, 128) + linear(3, 128) + linear(128, 128) + 2 * linear(256, 128)
    heads = 2 * linear(128, 128)
    decoder = linear(3, 128) + linear(128, 128) + 5 * 2 * linear(128, 128) + linear(128, 1)
    assert encoder + heads + decoder == 298_369
    assert sum(p.numel() for p in model.parameters()) == 298_369


def test_blocks_start_as_the_identity():
    model = OccNetGenerator(OccNetOptions(kind="occnet"))
    x = torch.randn(2, 3, 128)
    assert torch.equal(model.decoder.blocks(x), x)


def test_a_joint_layer_is_the_layer_of_both_side_by_side():
    layer = torch.nn.Linear(5, 4)
    points, shape = torch.randn(2, 7, 3), torch.randn(2, 2)
    repeated = shape[:, None].expand(-1, 7, -1)
    expected = layer(torch.cat([points, repeated], dim=-1))
    torch.testing.assert_close(joint_linear(layer, points, shape), expected, rtol=1e-5, atol=1e-6)


def test_encodes_as_a_pointnet_that_repeats_the_maximum_behind_each_point(model):
    data = torch.rand(2, 9, 4)
    encoder = model.encoder
    x = encoder.position(data[..., :3] - 0.5) + encoder.occupancy(data[..., 3:])
    x = encoder.first(torch.relu(x))
    for layer in encoder.pooled:
        pooled = x.max(dim=1, keepdim=True).values.expand_as(x)
        x = layer(torch.relu(torch.cat([x, pooled], dim=-1)))
    expected = encoder.mean(x.max(dim=1).values)
    torch.testing.assert_close(model.encode(data), expected, rtol=1e-4, atol=1e-5)


def test_a_code_does_not_depend_on_the_order_of_the_points(model):
    data = torch.rand(2, 9, 4)
    torch.testing.assert_close(model.encode(data), model.encode(data.flip(1)))


def test_only_as_many_points_are_encoded_as_in_training(model):
    data = torch.rand(2, 9, 4)
    model.encoded.fill_(6)
    torch.testing.assert_close(model.encode(data), model.posterior(data[:, :6])[0])


def test_values_are_of_each_point_by_itself(model):
    latent, points = torch.randn(2, 128), torch.rand(2, 6, 3)
    values = model.value(latent, points)
    assert values.shape == (2, 6)
    torch.testing.assert_close(model.value(latent, points[:, 2:3]), values[:, 2:3])


def test_the_surface_is_where_the_probability_is_the_threshold(model):
    assert torch.sigmoid(torch.tensor(model.level)).item() == pytest.approx(0.2)
    assert OccNetGenerator(OccNetOptions(kind="occnet", threshold=0.5)).level == math.log(1)


def test_draws_are_standard_normal(model):
    draws = torch.cat(list(draw_latents(model, 2000, seed=0, device="cpu")))
    assert draws.shape == (2000, 128)
    assert draws.mean().abs() < 0.01  # 256,000 numbers: five deviations
    assert draws.std().item() == pytest.approx(1, abs=0.01)
