"""MMD, COV and 1-NNA: answers by hand, loops, and sets with known answers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.evaluation.coverage import (
    TwoSets,
    bootstrap_measures,
    nearest_neighbor_accuracy,
    set_measures,
    two_sets,
)


def of_points(generated: np.ndarray, real: np.ndarray) -> TwoSets:
    """Points in place of shapes."""
    generated, real = (
        np.asarray(points, dtype=float).reshape(len(points), -1) for points in (generated, real)
    )

    def distances(a, b):
        return np.linalg.norm(a[:, None] - b[None], axis=2)

    return two_sets(distances(generated, generated), distances(real, real), distances(generated, real))


def by_loops(sets: TwoSets) -> dict[str, float]:
    n, m = sets.between.shape
    covered = {min(range(m), key=lambda j: sets.between[i, j]) for i in range(n)}
    right = 0
    for i in range(n):
        others = [(sets.generated[i, k], True) for k in range(n) if k != i]
        right += min(others + [(sets.between[i, j], False) for j in range(m)])[1]
    for j in range(m):
        others = [(sets.real[j, k], True) for k in range(m) if k != j]
        right += min(others + [(sets.between[i, j], False) for i in range(n)])[1]
    return {
        "mmd": sum(min(sets.between[i, j] for i in range(n)) for j in range(m)) / m,
        "cov": len(covered) / m,
        "nna": right / (n + m),
    }


def test_three_shapes_on_a_line_by_hand():
    got = set_measures(of_points([0.1, 0.3, 9.0], [0.0, 1.0, 10.0]))
    # Nearest generated to 0, 1 and 10 at 0.1, 0.7 and 1; 0.1 and 0.3 are both nearest to 0, so 1 is not
    # covered; of the six only 0.3 has a neighbour of its own set nearest.
    assert got == pytest.approx({"mmd": 0.6, "cov": 2 / 3, "nna": 1 / 6})


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**31), n=st.integers(2, 9), m=st.integers(2, 9))
def test_loops_give_the_same(seed, n, m):
    rng = np.random.default_rng(seed)
    sets = of_points(rng.normal(size=(n, 2)), rng.normal(size=(m, 2)))
    assert set_measures(sets) == pytest.approx(by_loops(sets))


def test_copies_cover_everything_and_cannot_be_told_apart():
    points = np.random.default_rng(0).normal(size=(20, 3))
    assert set_measures(of_points(points, points)) == {"mmd": 0, "cov": 1, "nna": 0}


def test_sets_that_are_apart_are_told_apart():
    rng = np.random.default_rng(0)
    got = set_measures(of_points(rng.random((20, 3)), rng.random((20, 3)) + 100))
    assert got["nna"] == 1
    assert got["mmd"] > 100


def test_a_collapsed_generator_covers_one_shape():
    rng = np.random.default_rng(0)
    real = rng.normal(size=(25, 3))
    collapsed = real[7] + 1e-9 * rng.normal(size=(25, 3))
    got = set_measures(of_points(collapsed, real))
    assert got["cov"] == 1 / 25
    assert got["nna"] > 0.85


def test_one_distribution_is_told_apart_half_of_the_time():
    rng = np.random.default_rng(0)
    values = [set_measures(of_points(*rng.normal(size=(2, 30, 2))))["nna"] for _ in range(100)]
    # A single value deviates by about 0.09; leave-one-out has a bias below 1 / (2 N).
    assert np.mean(values) == pytest.approx(0.5, abs=4 * 0.009 + 1 / 60)


def test_ties_are_half_right():
    assert set_measures(of_points([0.0, 0.0], [0.0, 0.0]))["nna"] == 0.5


def test_one_shape_is_no_set():
    with pytest.raises(ValueError, match="two shapes each"):
        two_sets(np.zeros((1, 1)), np.zeros((3, 3)), np.zeros((1, 3)))


def test_a_resample_counts_as_many_shapes_and_no_copy_is_a_neighbour():
    rng = np.random.default_rng(0)
    drawn = of_points(rng.normal(size=(12, 2)), rng.normal(size=(9, 2))).resample(rng)
    assert drawn.generated_weights.sum() == 12
    assert drawn.real_weights.sum() == 9
    assert (drawn.generated_weights >= 1).all()
    assert np.isinf(np.diag(drawn.generated)).all()
    assert drawn.between.shape == (len(drawn.generated_weights), len(drawn.real_weights))
    off = ~np.eye(len(drawn.generated), dtype=bool)
    assert (drawn.generated[off] > 0).all()


def test_weights_are_as_good_as_copies():
    sets = of_points([0.1, 0.3, 9.0], [0.0, 1.0, 10.0])
    weighted = sets._replace(real_weights=np.array([1.0, 3.0, 2.0]))
    assert set_measures(weighted)["mmd"] == pytest.approx((0.1 + 3 * 0.7 + 2 * 1.0) / 6)
    assert set_measures(weighted)["cov"] == pytest.approx(3 / 6)


def test_intervals_surround_the_value_and_repeat():
    rng = np.random.default_rng(0)
    sets = of_points(rng.normal(size=(40, 2)), rng.normal(size=(40, 2)))
    ends = bootstrap_measures(set_measures, sets, 100, 0.95, np.random.default_rng(1))
    for name, value in set_measures(sets).items():
        assert ends[name].low < value < ends[name].high
    assert bootstrap_measures(set_measures, sets, 100, 0.95, np.random.default_rng(1)) == ends


def only_nna(sets: TwoSets) -> dict[str, float]:
    return {"nna": nearest_neighbor_accuracy(sets)}


def test_the_interval_of_1_nna_covers_the_truth_about_as_often_as_it_says():
    # Two draws from one distribution: the truth is 1/2. 60 trials at 90 %: the binomial deviation is 4 %.
    rng = np.random.default_rng(0)
    covered = 0
    for _ in range(60):
        sets = of_points(*rng.normal(size=(2, 30, 2)))
        ends = bootstrap_measures(only_nna, sets, 50, 0.9, rng)["nna"]
        covered += ends.low <= 0.5 <= ends.high
    assert covered >= 48
