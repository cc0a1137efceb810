"""Planes of decoded fields are made to agree; exact ones stay."""

import numpy as np
import pytest

from tetgan.fields.field import Field
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.agreement import disagreements, make_planes_agree
from tetgan.meshing.planes import planes_of_field

GRID = build_hierarchy(2, 2).finest
EDGE = 0.12


def ball(noise, seed=0):
    from_centre = GRID.centroids - 0.5
    length = np.linalg.norm(from_centre, axis=1, keepdims=True)
    displacement = from_centre * (0.35 / length - 1)
    displacement += np.random.default_rng(seed).normal(scale=noise, size=displacement.shape)
    return planes_of_field(
        Field(length[:, 0] < 0.35, displacement.astype(np.float32)), GRID, length[:, 0] < 0.35
    )


def test_planes_of_one_plane_agree():
    normal = np.array([0.6, 0.8, 0.0])
    heights = GRID.centroids @ normal - 0.7
    field = Field(heights < 0, (-heights[:, None] * normal).astype(np.float32))
    planes = planes_of_field(field, GRID, field.occupancy)
    missed = disagreements(planes, GRID.neighbors)
    assert np.quantile(missed, 0.99) < 1e-5  # a centroid on the plane knows no direction
    assert make_planes_agree(planes, GRID.neighbors, EDGE) is planes


def test_a_disagreement_by_hand():
    planes = ball(0.0)
    tet = int(np.abs(planes.distances).argmin())
    misses = []
    for other in GRID.neighbors[tet]:
        way = GRID.centroids[other] - GRID.centroids[tet]
        expected = planes.distances[tet] + way @ planes.normals[tet]
        misses.append(abs(expected - planes.distances[other]) / np.linalg.norm(way))
    assert disagreements(planes, GRID.neighbors)[tet] == pytest.approx(sorted(misses)[1])


def test_exact_planes_stay():
    planes = ball(0.0)
    assert make_planes_agree(planes, GRID.neighbors, EDGE) is planes


def test_noisy_planes_come_nearer_to_the_truth():
    noisy, exact = ball(0.02), ball(0.0)
    agreed = make_planes_agree(noisy, GRID.neighbors, EDGE)
    near = np.abs(exact.distances) < 0.1
    before, after = (np.abs(each.distances - exact.distances)[near].mean() for each in (noisy, agreed))
    assert after < 0.7 * before
    assert (
        disagreements(agreed, GRID.neighbors)[near].mean() < disagreements(noisy, GRID.neighbors)[near].mean()
    )
    points = 0.5 + np.random.default_rng(1).normal(size=(300, 3))
    points = 0.5 + (points - 0.5) / np.linalg.norm(points - 0.5, axis=1, keepdims=True) * 0.35
    assert np.abs(agreed.distance(points)).mean() < np.abs(noisy.distance(points)).mean()


def test_no_centroid_changes_sides():
    noisy = ball(0.05)
    agreed = make_planes_agree(noisy, GRID.neighbors, EDGE)
    np.testing.assert_array_equal(np.sign(agreed.distances), np.sign(noisy.distances))
