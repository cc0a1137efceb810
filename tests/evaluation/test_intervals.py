"""Intervals: known cases and coverage."""

import numpy as np
import pytest

from tetgan.evaluation.intervals import (
    bootstrap_mean,
    percentile_interval,
    recentered_interval,
    student_interval,
)


def test_central_share_of_even_values():
    assert percentile_interval(np.linspace(0, 1, 101), 0.9) == pytest.approx((0.05, 0.95))


def test_recentered_interval_keeps_its_width():
    resampled = np.linspace(10, 12, 101)  # mean 11, biased away from a value of 3
    assert recentered_interval(3.0, resampled, 0.5) == pytest.approx((2.5, 3.5))


def test_equal_values_have_no_width():
    assert bootstrap_mean(np.full(5, 2.0), 50, 0.95, np.random.default_rng(0)) == (2, 2)


def test_students_interval_of_five_values():
    # mean 3, standard error sqrt(2.5 / 5); t(0.975, 4) = 2.7764451 from a printed table
    low, high = student_interval(np.arange(1.0, 6.0), 0.95)
    assert (low, high) == pytest.approx(
        (3 - 2.7764451 * np.sqrt(0.5), 3 + 2.7764451 * np.sqrt(0.5)), rel=1e-7
    )


@pytest.mark.parametrize("size", [0, 1])
def test_too_few_values_have_no_interval(size):
    assert np.isnan(bootstrap_mean(np.ones(size), 50, 0.95, np.random.default_rng(0))).all()
    assert np.isnan(student_interval(np.ones(size), 0.95)).all()


def test_bootstrap_covers_a_skewed_mean_nearly_as_often_as_it_says():
    # 95 % of 400 exponential samples of 40. The percentile bootstrap is known to fall a little short there;
    # binomial deviation 1.1 %.
    rng = np.random.default_rng(0)
    covered = 0
    for _ in range(400):
        low, high = bootstrap_mean(rng.exponential(size=40), 300, 0.95, rng)
        covered += low <= 1 <= high
    assert 0.89 <= covered / 400 <= 0.98


def test_student_covers_five_normal_values_where_the_bootstrap_does_not():
    # Why repeats get Student's interval: 400 trials, binomial deviation 1.1 %.
    rng = np.random.default_rng(0)
    draws = rng.normal(size=(400, 5))
    student = np.mean([low <= 0 <= high for low, high in (student_interval(d, 0.95) for d in draws)])
    boot = np.mean([low <= 0 <= high for low, high in (bootstrap_mean(d, 200, 0.95, rng) for d in draws)])
    assert 0.92 <= student <= 0.98
    assert boot < 0.9
