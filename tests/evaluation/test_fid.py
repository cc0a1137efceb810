"""Fréchet and kernel distances: closed forms and invariants."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import sqrtm

from tetgan.evaluation.fid import fid, fid_interval, kid, kid_interval


def exact_gaussian(size: int, mean: np.ndarray, deviations: np.ndarray, seed: int = 0) -> np.ndarray:
    """Samples whose mean and covariance are exactly those asked for."""
    raw = np.random.default_rng(seed).normal(size=(size, len(mean)))
    raw -= raw.mean(0)
    white = raw @ np.linalg.inv(np.linalg.cholesky(np.cov(raw.T).reshape(len(mean), -1))).T
    return mean + white * deviations


def test_one_dimensional_gaussians_have_a_closed_form():
    # (m1 - m2)^2 + (s1 - s2)^2 = 4 + 1
    first = exact_gaussian(50, np.array([0.0]), np.array([1.0]), seed=1)
    second = exact_gaussian(70, np.array([2.0]), np.array([2.0]), seed=2)
    assert fid(first, second) == pytest.approx(5.0, rel=1e-12)


def test_axis_aligned_gaussians_add_up():
    first = exact_gaussian(90, np.zeros(3), np.array([1.0, 2.0, 3.0]), seed=1)
    second = exact_gaussian(90, np.array([1.0, 0.0, 0.0]), np.array([1.0, 3.0, 5.0]), seed=2)
    assert fid(first, second) == pytest.approx(1 + 0 + 1 + 4, rel=1e-10)


def test_a_collapsed_generator_is_as_far_as_the_spread_that_it_lacks():
    # All at one point: squared distance of the means, and the whole variance of the others.
    others = exact_gaussian(90, np.zeros(3), np.array([1.0, 2.0, 3.0]), seed=1)
    collapsed = np.tile([2.0, 0.0, 1.0], (90, 1))
    assert fid(collapsed, others) == pytest.approx(4 + 1 + 1 + 4 + 9, rel=1e-9)


def test_matrix_root_gives_the_same():
    rng = np.random.default_rng(3)
    first, second = rng.normal(size=(60, 8)) @ rng.normal(size=(8, 8)), rng.normal(size=(50, 8)) + 0.3
    cov_first, cov_second = np.cov(first.T), np.cov(second.T)
    cross = sqrtm(cov_first @ cov_second).real
    expected = ((first.mean(0) - second.mean(0)) ** 2).sum() + np.trace(cov_first + cov_second - 2 * cross)
    assert fid(first, second) == pytest.approx(expected, rel=1e-9)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**31), features=st.integers(1, 12), size=st.integers(2, 20))
def test_distance_to_itself_is_zero_and_order_does_not_matter(seed, features, size):
    # Fewer samples than features, too: singular covariances are no special case.
    rng = np.random.default_rng(seed)
    first, second = rng.normal(size=(size, features)), rng.normal(size=(size + 1, features))
    assert fid(first, first) == pytest.approx(0, abs=1e-12 * features)
    assert fid(first, second) == pytest.approx(fid(second, first), rel=1e-9)
    assert fid(first, second) >= 0


def test_features_of_single_precision_are_measured_in_double():
    rng = np.random.default_rng(0)
    far = (rng.normal(size=(40, 4)) + 1000).astype(np.float32)
    assert fid(far, far) == pytest.approx(0, abs=1e-9)


def test_one_sample_has_no_covariance():
    with pytest.raises(ValueError, match="two samples"):
        fid(np.zeros((1, 2)), np.zeros((5, 2)))


def kernel_by_loop(x: np.ndarray, y: np.ndarray) -> float:
    return (x @ y / len(x) + 1) ** 3


def test_kid_agrees_with_a_loop():
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(6, 3)), rng.normal(size=(5, 3)) + 1
    within = [
        np.mean([kernel_by_loop(x, y) for i, x in enumerate(s) for j, y in enumerate(s) if i != j])
        for s in (first, second)
    ]
    between = np.mean([kernel_by_loop(x, y) for x in first for y in second])
    got = kid(first, second, 3, 5, np.random.default_rng(0))
    assert got.value == pytest.approx(sum(within) - 2 * between, rel=1e-12)
    assert got.std > 0


def test_blocks_of_everything_have_no_deviation():
    rng = np.random.default_rng(0)
    assert np.isnan(kid(rng.normal(size=(9, 2)), rng.normal(size=(9, 2)), 100, 7, rng).std)
    assert kid(rng.normal(size=(9, 2)), rng.normal(size=(9, 2)), 5, 7, rng).std > 0


def test_kid_of_one_distribution_is_zero_on_average():
    # Unbiased: over 400 pairs of sets the mean lies within four standard errors of zero.
    rng = np.random.default_rng(0)
    values = [kid(*rng.normal(size=(2, 12, 4)), 12, 1, rng).value for _ in range(400)]
    assert abs(np.mean(values)) < 4 * np.std(values) / 20


def test_fid_is_biased_where_kid_is_not():
    # Why KID leads at small N: two draws from one distribution, and FID grows as N shrinks.
    rng = np.random.default_rng(0)
    few, many = (np.mean([fid(*rng.normal(size=(2, n, 16))) for _ in range(20)]) for n in (32, 512))
    assert few > 5 * many > 0


@pytest.mark.parametrize("interval", [fid_interval, kid_interval])
def test_intervals_surround_the_value_and_repeat(interval):
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(60, 4)), rng.normal(size=(60, 4)) + 0.5
    value = fid(first, second) if interval is fid_interval else kid(first, second, 2, 1, rng).value
    low, high = interval(first, second, 200, 0.95, np.random.default_rng(1))
    assert low < value < high
    assert interval(first, second, 200, 0.95, np.random.default_rng(1)) == (low, high)


def test_kid_interval_covers_the_truth_about_as_often_as_it_says():
    # The true distance is 0. 200 trials at 90 %: binomial deviation 2 %, plus what a bootstrap of 40 is off.
    rng = np.random.default_rng(0)
    covered = 0
    for _ in range(200):
        low, high = kid_interval(*rng.normal(size=(2, 40, 3)), 100, 0.9, rng)
        covered += low <= 0 <= high
    assert 160 <= covered <= 200


def test_the_deviation_is_that_of_random_blocks():
    """Blocks of two of three samples: three values, each as likely as the others."""
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(3, 2)), rng.normal(size=(2, 2))

    def whole(*chosen: int) -> float:
        return kid(first[list(chosen)], second, 2, 1, rng).value

    expected = np.std([whole(0, 1), whole(0, 2), whole(1, 2)])
    # 4,000 blocks know a deviation to about 1 / √8000 = 0.011 of it.
    assert kid(first, second, 2, 4000, rng).std == pytest.approx(expected, rel=0.05)
    assert np.isfinite(kid(first, second, 2, 2, rng).std)
