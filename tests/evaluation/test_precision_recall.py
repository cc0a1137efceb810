"""Precision and recall: sets with known answers, and a loop."""

import numpy as np
import pytest

from tetgan.evaluation.precision_recall import NEIGHBORS, feature_sets, precision_recall


def measure(found: np.ndarray, real: np.ndarray) -> dict[str, float]:
    return precision_recall(feature_sets(found, real))


def share_inside(queries: np.ndarray, members: np.ndarray) -> float:
    """By loops, from the definition."""
    inside = 0
    for query in queries:
        for k, member in enumerate(members):
            others = sorted(np.linalg.norm(member - other) for i, other in enumerate(members) if i != k)
            if np.linalg.norm(query - member) <= others[NEIGHBORS - 1]:
                inside += 1
                break
    return inside / len(queries)


def test_loops_give_the_same():
    rng = np.random.default_rng(0)
    found, real = rng.normal(size=(15, 4)), rng.normal(size=(12, 4)) + 0.7
    got = measure(found, real)
    assert got == pytest.approx({"precision": share_inside(found, real), "recall": share_inside(real, found)})
    assert 0 < got["precision"] < 1


def test_equal_sets_have_all_of_both():
    features = np.random.default_rng(0).normal(size=(20, 8))
    assert measure(features, features) == {"precision": 1, "recall": 1}


def test_sets_that_are_apart_have_none_of_either():
    rng = np.random.default_rng(0)
    assert measure(rng.normal(size=(20, 8)), rng.normal(size=(20, 8)) + 100) == {"precision": 0, "recall": 0}


def test_a_collapsed_generator_is_precise_and_recalls_nothing():
    rng = np.random.default_rng(0)
    real = rng.normal(size=(30, 8))
    collapsed = real[3] + 1e-9 * (1 + rng.random((30, 8)))
    assert measure(collapsed, real) == {"precision": 1, "recall": 0}


def test_rubbish_beside_good_shapes_costs_precision_alone():
    rng = np.random.default_rng(0)
    real = rng.normal(size=(20, 4))
    found = np.concatenate([real, 100 * (1 + np.arange(20))[:, None] + rng.normal(size=(20, 4))])
    got = measure(found, real)
    assert got["precision"] == 0.5
    assert got["recall"] == 1


def test_fewer_than_three_neighbours_know_no_bounds():
    assert measure(np.zeros((2, 1)), np.ones((3, 1))) == {"precision": 1, "recall": 1}


def test_the_border_of_a_ball_belongs_to_it():
    # Third neighbours are 3, 2, 2 and 3 away: -3 and 6 lie on a border, 20 and 30 in no ball.
    found, real = np.array([[-3.0], [6.0], [20.0], [30.0]]), np.arange(4.0)[:, None]
    assert measure(found, real)["precision"] == 0.5
    assert measure(real, found)["recall"] == 0.5
