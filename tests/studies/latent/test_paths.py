"""Paths between latents and sums of them."""

import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.errors import UserError
from tetgan.models.files import load_generator
from tetgan.studies.latent.paths import LatentSpace, add_difference, interpolate

PATHS = ("linear", "spherical")


def draw(seed: int, *shape: int) -> torch.Tensor:
    return torch.randn(*shape, generator=torch.Generator().manual_seed(seed))


@settings(deadline=None)
@given(seed=st.integers(0, 1000), steps=st.integers(2, 9), path=st.sampled_from(PATHS))
def test_both_ends_are_exact_and_the_way_back_is_the_same(seed, steps, path):
    first, second = draw(seed, 2, 3, 5)
    forth, back = interpolate(first, second, steps, path), interpolate(second, first, steps, path)
    assert forth.shape == (steps, 3, 5)
    torch.testing.assert_close(forth[0], first)
    torch.testing.assert_close(forth[-1], second)
    torch.testing.assert_close(forth.flip(0), back)


def test_a_straight_path_has_equal_steps():
    path = interpolate(torch.tensor([0.0, 1.0]), torch.tensor([1.0, -1.0]), 5, "linear")
    assert path.tolist() == [[0, 1], [0.25, 0.5], [0.5, 0], [0.75, -0.5], [1, -1]]


def test_a_turn_keeps_the_length_and_has_equal_angles():
    # A quarter turn in three steps: 0, 30, 60, 90 degrees.
    path = interpolate(torch.tensor([2.0, 0.0]), torch.tensor([0.0, 2.0]), 4, "spherical")
    angles = torch.tensor([0, 30, 60, 90]) * math.pi / 180
    torch.testing.assert_close(path, 2 * torch.stack([angles.cos(), angles.sin()], dim=1))


@pytest.mark.parametrize("scale", [1.0, -1.0, 3.0, 0.0])
def test_parallel_latents_are_joined_by_a_line(scale):
    first = draw(0, 4)
    turned = interpolate(first, scale * first, 5, "spherical")
    torch.testing.assert_close(turned, interpolate(first, scale * first, 5, "linear"))


def test_one_step_is_refused():
    with pytest.raises(ValueError, match="1 steps"):
        interpolate(draw(0, 4), draw(1, 4), 1, "linear")


@settings(deadline=None)
@given(seed=st.integers(0, 1000))
def test_a_minus_a_plus_c_is_c(seed):
    a, c = draw(seed, 2, 6, 4)
    assert torch.equal(add_difference(a, a, c), c)


def test_a_minus_b_plus_b_is_a():
    a, b = draw(0, 2, 6)
    torch.testing.assert_close(add_difference(a, b, b), a)


def test_shapes_are_encoded_by_id_and_decoded_as_they_were(model, store):
    space = LatentSpace(load_generator(model, store.hierarchy), store)
    ids = ["wide", "train-3"]
    for shape_id, field in zip(ids, space.decode(space.encode(ids)), strict=True):
        assert (field.occupancy == store.read(shape_id).occupancy).all()
    with pytest.raises(UserError, match="no shape 'sofa'"):
        space.encode(["wide", "sofa"])
