"""All pairs at once: the same distances as pair by pair."""

import numpy as np
import pytest

from tetgan.evaluation import chamfer as pairwise
from tetgan.evaluation.chamfer import (
    SurfaceSample,
    chamfer,
    chamfer_between,
    chamfer_within,
    resampled_chamfer,
)

# Single precision: a few units in the last place of the clouds' squared extent.
EXACT = 1e-6


def by_tree(first: np.ndarray, second: np.ndarray) -> float:
    return chamfer(SurfaceSample(first, first), SurfaceSample(second, second))


@pytest.fixture
def clouds():
    rng = np.random.default_rng(0)
    return rng.random((5, 40, 3)), rng.random((4, 30, 3)) + 0.2


def test_every_pair_agrees_with_a_tree(clouds):
    first, second = clouds
    expected = [[by_tree(a, b) for b in second] for a in first]
    np.testing.assert_allclose(chamfer_between(first, second), expected, atol=EXACT)


def test_within_a_set_agrees_with_between_and_is_symmetric(clouds):
    within = chamfer_within(clouds[0])
    np.testing.assert_allclose(within, chamfer_between(clouds[0], clouds[0]), atol=EXACT)
    np.testing.assert_array_equal(within, within.T)
    assert (np.diag(within) == 0).all()


def test_blocks_do_not_matter(clouds, monkeypatch):
    whole = chamfer_between(*clouds)
    monkeypatch.setattr(pairwise, "_BLOCK", dict.fromkeys(pairwise._BLOCK, 1))
    np.testing.assert_allclose(chamfer_between(*clouds), whole, atol=EXACT)


def test_clouds_far_from_the_origin_lose_no_digits(clouds):
    first, second = clouds
    np.testing.assert_allclose(
        chamfer_between(first + 1000, second + 1000), chamfer_between(first, second), atol=EXACT
    )


def test_a_sphere_sampled_twice_measures_its_area():
    # Mean squared distance to the nearest of n points of density n / A is A / (pi n), each way; here A = pi.
    points = np.random.default_rng(0).normal(size=(4000, 3))
    points *= 0.5 / np.linalg.norm(points, axis=1, keepdims=True)
    # The deviation of the mean of 2000 exponential distances, both ways, is about 3 %.
    assert resampled_chamfer(points, 2000) == pytest.approx(2 / 2000, rel=0.1)
    assert resampled_chamfer(points[:1000], 2000) == pytest.approx(2 / 500, rel=0.2)
