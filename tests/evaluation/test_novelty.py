"""Novelty: copies are found, and score what sampling costs; both searches find what a plain one does."""

import math

import numpy as np
import pytest

from tetgan.evaluation.chamfer import SurfaceSample, chamfer, chamfer_between
from tetgan.evaluation.novelty import find_nearest, nearest_training


def sphere(rng: np.random.Generator, radius: float) -> np.ndarray:
    points = rng.normal(size=(400, 3))
    return 0.5 + radius * points / np.linalg.norm(points, axis=1, keepdims=True)


def test_copies_find_their_originals():
    rng = np.random.default_rng(0)
    radii = np.linspace(0.1, 0.45, 6)
    training = np.array([sphere(rng, radius) for radius in radii])
    order = rng.permutation(6)
    found = nearest_training(np.array([sphere(rng, radii[i]) for i in order]), training)
    np.testing.assert_array_equal(found.shape, order)
    # Area / (pi n), each way; 400 nearest distances deviate by about 7 % from that.
    np.testing.assert_allclose(found.distance, 2 * 4 * radii[order] ** 2 / 400, rtol=0.3)


def test_what_was_not_seen_lies_farther():
    rng = np.random.default_rng(0)
    training = np.array([sphere(rng, 0.2), sphere(rng, 0.3)])
    new = nearest_training(np.array([sphere(rng, 0.4)]), training)
    # Two spheres around one centre, 0.1 apart, each way, and little more for the sampling.
    assert new.shape[0] == 1
    assert new.distance[0] == pytest.approx(2 * 0.1**2, rel=0.2)


def test_measuring_every_shape_finds_the_same():
    # Ellipsoids that differ by little: nothing but their shape tells them apart.
    rng = np.random.default_rng(0)
    axes = rng.uniform(0.7, 1.3, (70, 1, 3))
    clouds = np.array([sphere(rng, 0.3) for _ in range(70)]) * axes
    found, training = clouds[:10], clouds[10:]
    distances = chamfer_between(found, training)
    got = nearest_training(found, training)
    np.testing.assert_array_equal(got.shape, distances.argmin(1))
    np.testing.assert_allclose(got.distance, distances.min(1), atol=1e-6)


def test_both_searches_find_the_same():
    rng = np.random.default_rng(0)
    clouds = np.array([cloud(rng, 600).points for _ in range(40)])
    table = nearest_training(clouds[:6], clouds[6:])
    samples = [SurfaceSample(points, points) for points in clouds]
    figure = [find_nearest(shape, samples[6:]) for shape in samples[:6]]
    assert [row for row, _ in figure] == table.shape.tolist()
    np.testing.assert_allclose([distance for _, distance in figure], table.distance, atol=1e-6)


def cloud(rng: np.random.Generator, points: int) -> SurfaceSample:
    """Points in a box of some size and place."""
    size, place = rng.uniform(0.2, 0.5, 3), rng.uniform(0, 0.3, 3)
    inside = place + size * rng.random((points, 3))
    return SurfaceSample(inside, np.tile([0.0, 0, 1], (points, 1)))


@pytest.mark.parametrize("points", [100, 3000])
def test_it_finds_what_a_plain_search_finds(points):
    rng = np.random.default_rng(points)
    candidates = [cloud(rng, points) for _ in range(12)]
    for _ in range(4):
        shape = cloud(rng, points)
        plain = [chamfer(shape, candidate) for candidate in candidates]
        assert find_nearest(shape, candidates) == (int(np.argmin(plain)), min(plain))


def test_nothing_is_nearest_to_nothing():
    rng = np.random.default_rng(0)
    row, distance = find_nearest(None, [cloud(rng, 100)])
    assert row is None and math.isnan(distance)
    assert find_nearest(cloud(rng, 100), [])[0] is None
