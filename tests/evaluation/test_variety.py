"""Variety: the shortcut against all distances, and cases whose answer is known."""

import numpy as np
import pytest

from tetgan.evaluation.chamfer import SurfaceSample, chamfer
from tetgan.evaluation.options import VarietyOptions
from tetgan.evaluation.variety import shapes_needed, variety


def boxes(count: int, points: int = 3000, seed: int = 0) -> list[SurfaceSample]:
    """Points on the floors of boxes of random sizes."""
    rng = np.random.default_rng(seed)
    sizes = rng.uniform(0.2, 1, size=(count, 2))
    return [
        SurfaceSample(
            np.c_[rng.random((points, 2)) * size, np.zeros(points)], np.tile([0.0, 0, 1], (points, 1))
        )
        for size in sizes
    ]


def all_distances(samples: list[SurfaceSample]) -> np.ndarray:
    size = len(samples)
    return np.array(
        [[chamfer(samples[i], samples[j]) if i < j else np.inf for j in range(size)] for i in range(size)]
    )


def test_appendix_is_the_mean_of_the_closest_of_all_pairs():
    samples = boxes(12)
    options = VarietyOptions(definition="appendix", pairs=12, closest=5, repeats=2)
    expected = np.sort(all_distances(samples).ravel())[:5].mean()
    assert variety(samples, options, np.random.default_rng(0)) == pytest.approx([expected, expected])


def test_text_draws_every_pair_when_there_are_no_more():
    samples = boxes(8)
    options = VarietyOptions(pairs=28, closest=4, repeats=3)
    expected = np.sort(all_distances(samples).ravel())[:4].mean()
    assert variety(samples, options, np.random.default_rng(0)) == pytest.approx([expected] * 3)


def test_text_agrees_with_measuring_every_drawn_pair():
    samples = boxes(15)
    options = VarietyOptions(pairs=30, closest=6, repeats=2)
    distances = all_distances(samples)
    rng = np.random.default_rng(4)
    first, second = np.triu_indices(15, 1)
    drawn = [rng.choice(105, 30, replace=False) for _ in range(2)]
    expected = [np.sort(distances[first[d], second[d]])[:6].mean() for d in drawn]
    assert variety(samples, options, np.random.default_rng(4)) == pytest.approx(expected, rel=1e-12)


def test_identical_shapes_vary_by_the_noise_floor_alone():
    rng = np.random.default_rng(0)
    samples = [
        SurfaceSample(np.c_[rng.random((2000, 2)), np.zeros(2000)], np.tile([0.0, 0, 1], (2000, 1)))
        for _ in range(8)
    ]
    options = VarietyOptions(pairs=20, closest=10, repeats=2)
    floor = 2 / (np.pi * 2000)  # of a unit square, see test_chamfer
    assert variety(samples, options, rng) == pytest.approx([floor, floor], rel=0.1)


def test_threads_and_repetition_change_nothing():
    samples = boxes(9)
    options = VarietyOptions(pairs=20, closest=3, repeats=2)
    one = variety(samples, options, np.random.default_rng(7))
    assert variety(samples, options, np.random.default_rng(7), threads=2).tolist() == one.tolist()


@pytest.mark.parametrize(("pairs", "needed"), [(1, 2), (3, 3), (4, 4), (250, 23)])
def test_shapes_needed_for_so_many_pairs(pairs, needed):
    assert shapes_needed(VarietyOptions(pairs=pairs, closest=1)) == needed
    assert shapes_needed(VarietyOptions(pairs=max(pairs, 2), closest=1, definition="appendix")) == max(
        pairs, 2
    )


def test_too_few_shapes_are_an_error():
    with pytest.raises(ValueError, match="needs 4 shapes, not 3"):
        variety(boxes(3, points=100), VarietyOptions(pairs=4, closest=1), np.random.default_rng(0))


def test_more_closest_than_pairs_is_a_bad_option():
    with pytest.raises(ValueError, match="exceeds the 3 pairs"):
        VarietyOptions(definition="appendix", pairs=3, closest=4)
