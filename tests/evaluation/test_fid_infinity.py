"""FID without its bias: an exact line, and Gaussians whose distance is known."""

import numpy as np
import pytest

from tetgan.evaluation import fid as extrapolation
from tetgan.evaluation.fid import fid, fid_infinity, fid_infinity_interval


def test_a_bias_proportional_to_one_over_n_is_taken_away(monkeypatch):
    monkeypatch.setattr(extrapolation, "fid", lambda first, second: 3 + 7 / len(first))
    features = np.zeros((48, 2))
    assert fid_infinity(features, features, np.random.default_rng(0)) == pytest.approx(3)


def test_parts_are_disjoint_and_of_both_sets(monkeypatch):
    seen: list[tuple[tuple[float, ...], tuple[float, ...]]] = []

    def record(first, second):
        seen.append((tuple(first[:, 0]), tuple(second[:, 0])))
        return 1 / len(first)

    monkeypatch.setattr(extrapolation, "fid", record)
    found, real = np.arange(12.0)[:, None], 100 + np.arange(12.0)[:, None]
    fid_infinity(found, real, np.random.default_rng(0))
    assert [len(first) for first, _ in seen] == [12, 6, 6, 4, 4, 4, 3, 3, 3, 3]
    for side, everything in ((0, found), (1, real)):
        for start, stop in ((0, 1), (1, 3), (3, 6), (6, 10)):
            joined = sum((each[side] for each in seen[start:stop]), ())
            assert sorted(joined) == list(everything[:, 0])


def test_shifted_gaussians_are_their_shift_apart_and_fid_says_more():
    # The true distance is |shift|^2 = 4. Means of 12 draws; the bias of FID at N = 128 in 16 dimensions is
    # about 1, the deviation of a mean about 0.1.
    rng = np.random.default_rng(0)
    shift = np.zeros(16)
    shift[0] = 2
    draws = [(rng.normal(size=(128, 16)), rng.normal(size=(128, 16)) + shift) for _ in range(12)]
    biased = np.mean([fid(*draw) for draw in draws])
    corrected = np.mean([fid_infinity(*draw, rng) for draw in draws])
    assert biased > 4.5
    assert abs(corrected - 4) < 0.3 * (biased - 4)


def test_one_distribution_is_near_zero():
    rng = np.random.default_rng(0)
    pairs = [rng.normal(size=(2, 200, 8)) for _ in range(12)]
    assert abs(np.mean([fid_infinity(*pair, rng) for pair in pairs])) < 0.3 * np.mean(
        [fid(*pair) for pair in pairs]
    )


def test_the_interval_surrounds_the_value_and_repeats():
    rng = np.random.default_rng(0)
    found, real = rng.normal(size=(60, 4)), rng.normal(size=(60, 4)) + 0.5
    value = fid_infinity(found, real, np.random.default_rng(2))

    def interval():
        return fid_infinity_interval(
            found, real, value=value, resamples=60, level=0.95, rng=np.random.default_rng(1)
        )

    low, high = interval()
    assert low < value < high
    assert interval() == (low, high)


def test_too_few_samples_cannot_be_cut():
    with pytest.raises(ValueError, match="at least 4"):
        fid_infinity(np.zeros((3, 2)), np.zeros((3, 2)), np.random.default_rng(0))
