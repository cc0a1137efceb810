"""Jensen–Shannon divergence: closed forms and another implementation."""

import numpy as np
import pytest
from scipy.spatial.distance import jensenshannon

from tetgan.evaluation.jsd import CELLS, cell_counts, jensen_shannon, jsd, jsd_interval


def test_two_cells_have_a_closed_form():
    # p = (1, 0), q = (1/2, 1/2), their mean (3/4, 1/4): H(3/4, 1/4) - (0 + 1) / 2
    expected = -(0.75 * np.log2(0.75) + 0.25 * np.log2(0.25)) - 0.5
    assert jensen_shannon(np.array([3.0, 0.0]), np.array([5.0, 5.0])) == pytest.approx(expected)


def test_scipy_gives_the_same():
    p, q = np.random.default_rng(0).integers(0, 5, (2, 50)).astype(float)
    assert jensen_shannon(p, q) == pytest.approx(jensenshannon(p, q, base=2) ** 2)


def test_equal_sets_have_none_and_sets_apart_have_one_bit():
    clouds = 0.4 * np.random.default_rng(0).random((4, 60, 3))
    assert jsd(clouds, clouds) == 0
    assert jsd(clouds, clouds + 0.5) == pytest.approx(1)


def test_points_are_counted_in_their_cell_and_outside_in_the_nearest():
    side = 1 / CELLS
    cloud = np.array([[0.5 * side, 0.5 * side, 1.5 * side], [-3.0, -1.0, 0.0], [2.0, 0.999, 1.0]])
    counts = cell_counts(cloud[None])[0]
    assert counts[1] == 1
    assert counts[0] == 1
    assert counts[-1] == 1
    assert counts.sum() == 3


def test_only_where_points_are_matters_not_in_which_shape():
    rng = np.random.default_rng(0)
    clouds, others = rng.random((2, 6, 50, 3))
    mixed = rng.permutation(clouds.reshape(-1, 3)).reshape(clouds.shape)
    assert jsd(clouds, others) == pytest.approx(jsd(mixed, others))


def test_the_interval_surrounds_the_value_and_repeats():
    rng = np.random.default_rng(0)
    first, second = rng.random((20, 80, 3)) ** 2, rng.random((20, 80, 3))
    low, high = jsd_interval(first, second, 100, 0.95, np.random.default_rng(1))
    assert low < jsd(first, second) < high
    assert jsd_interval(first, second, 100, 0.95, np.random.default_rng(1)) == (low, high)
