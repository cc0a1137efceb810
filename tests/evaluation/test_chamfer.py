"""Distances between surfaces: closed forms, symmetry, and a loop."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.evaluation.chamfer import SurfaceSample, chamfer, compare_surfaces, nearest


def sample(points: np.ndarray, normal: tuple[float, float, float] = (0, 0, 1)) -> SurfaceSample:
    return SurfaceSample(
        np.asarray(points, dtype=float), np.tile(np.array(normal, dtype=float), (len(points), 1))
    )


def random_sample(seed: int, size: int) -> SurfaceSample:
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(size, 3))
    return SurfaceSample(rng.random((size, 3)), normals / np.linalg.norm(normals, axis=1, keepdims=True))


def grid_plane(height: float) -> np.ndarray:
    x, y = np.meshgrid(np.arange(8.0), np.arange(8.0))
    return np.stack([x.ravel(), y.ravel(), np.full(64, height)], axis=1)


def test_shifted_points_are_twice_the_square_apart():
    # Every nearest point is straight above: h^2 each way.
    assert chamfer(sample(grid_plane(0)), sample(grid_plane(0.25))) == pytest.approx(2 * 0.25**2, rel=1e-12)


def test_all_measures_of_shifted_points_by_hand():
    distance = compare_surfaces(sample(grid_plane(0)), sample(grid_plane(0.25), (0, 0, -1)), threshold=0.3)
    assert distance.chamfer == pytest.approx(0.125)
    assert distance.chamfer_l1 == pytest.approx(0.25)
    assert distance.fscore == 1
    assert distance.normal_consistency == pytest.approx(1)  # the side of a face plays no part


def test_fscore_is_the_harmonic_mean_of_two_shares():
    # All points of the half are found in the whole; half of the whole's are found in the half.
    whole = sample(grid_plane(0))
    half = sample(grid_plane(0)[:32])
    assert compare_surfaces(half, whole, threshold=0.5).fscore == pytest.approx(2 * 1 * 0.5 / 1.5)


def test_fscore_of_nothing_found_is_zero():
    assert compare_surfaces(sample(grid_plane(0)), sample(grid_plane(9)), threshold=0.1).fscore == 0


def test_crossed_normals_do_not_agree():
    got = compare_surfaces(sample(grid_plane(0)), sample(grid_plane(0), (1, 0, 0)), threshold=0.1)
    assert got.normal_consistency == 0


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**31), sizes=st.tuples(st.integers(1, 60), st.integers(1, 60)))
def test_measures_are_symmetric_and_agree_with_a_loop(seed, sizes):
    first, second = random_sample(seed, sizes[0]), random_sample(seed + 1, sizes[1])
    gaps = np.linalg.norm(first.points[:, None] - second.points, axis=2)
    assert chamfer(first, second) == pytest.approx((gaps.min(1) ** 2).mean() + (gaps.min(0) ** 2).mean())
    assert nearest(first.points, second)[1].tolist() == gaps.argmin(1).tolist()
    forth, back = compare_surfaces(first, second, 0.2), compare_surfaces(second, first, 0.2)
    assert forth == pytest.approx(back, rel=1e-12)
    assert forth.chamfer == chamfer(first, second)
    assert forth.chamfer_l1 == pytest.approx((gaps.min(1).mean() + gaps.min(0).mean()) / 2)


def test_noise_floor_of_one_square_sampled_twice():
    # Poisson points of density n: the mean squared distance to the nearest is 1 / (pi n), so the floor of a
    # unit square is 2 / (pi n); the border, where neighbours are missing, adds a few per cent.
    rng = np.random.default_rng(0)
    squares = [sample(np.c_[rng.random((10_000, 2)), np.zeros(10_000)]) for _ in range(2)]
    assert chamfer(*squares) == pytest.approx(2 / (np.pi * 10_000), rel=0.06)
