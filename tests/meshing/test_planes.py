"""Distances from the planes of tets."""

import numpy as np
import pytest

from tetgan.fields.field import Field
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.planes import planes_of_field

GRID = build_hierarchy(2, 1).finest


def plane_field(normal, offset):
    distance = GRID.centroids @ normal - offset
    return Field(distance < 0, (-distance[:, None] * normal).astype(np.float32))


def ball_field(radius):
    from_centre = GRID.centroids - 0.5
    length = np.linalg.norm(from_centre, axis=1, keepdims=True)
    return Field(length[:, 0] < radius, (from_centre * (radius / length - 1)).astype(np.float32))


def test_a_plane_is_met_exactly():
    normal = np.array([2.0, -1.0, 2.0]) / 3
    planes = planes_of_field(plane_field(normal, 0.4), GRID, plane_field(normal, 0.4).occupancy)
    points = np.random.default_rng(0).random((200, 3))
    points = points[points @ normal - 0.4 > np.abs(points - 0.5).max(axis=1) - 0.5]  # else the wall is nearer
    distance, direction = planes.distance_and_normal(points)
    np.testing.assert_allclose(distance, points @ normal - 0.4, atol=1e-6)
    np.testing.assert_allclose(direction, np.tile(normal, (len(points), 1)), atol=1e-5)
    inner = points[np.abs(points - 0.5).max(axis=1) < 0.2]
    np.testing.assert_allclose(planes.project(inner, 1.0) @ normal, 0.4, atol=1e-6)
    np.testing.assert_allclose(planes.feet @ normal, 0.4, atol=1e-6)
    np.testing.assert_array_equal(planes.distance(points), distance)


def test_a_step_is_no_longer_than_its_reach():
    normal = np.array([0.0, 1.0, 0.0])
    planes = planes_of_field(plane_field(normal, 0.5), GRID, plane_field(normal, 0.5).occupancy)
    (moved,) = planes.project(np.array([[0.5, 0.9, 0.5]]), 0.1)
    np.testing.assert_allclose(moved, [0.5, 0.7, 0.5], atol=1e-6)


def test_a_ball_is_met_nearly():
    field = ball_field(0.35)
    planes = planes_of_field(field, GRID, field.occupancy)
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = 0.5 + directions * rng.uniform(0.3, 0.4, (200, 1))
    distances = np.linalg.norm(points - 0.5, axis=1) - 0.35
    np.testing.assert_allclose(planes.distance(points), distances, atol=0.03)  # a tet is 0.3 across
    projected = planes.project(points, 0.1)
    assert np.abs(np.linalg.norm(projected - 0.5, axis=1) - 0.35).mean() < 0.015


def test_far_from_the_surface_the_nearest_centroid_tells_the_side():
    field = ball_field(0.35)
    planes = planes_of_field(field, GRID, field.occupancy)
    assert planes.inside(np.array([[0.5, 0.5, 0.5], [0.02, 0.02, 0.02]])).tolist() == [True, False]


def test_emptied_tets_are_left_out():
    field = ball_field(0.35)
    filtered = field.occupancy.copy()
    emptied = np.flatnonzero(filtered)[:3]
    filtered[emptied] = False
    planes = planes_of_field(field, GRID, filtered)
    assert len(planes.centroids) == len(GRID.tets) - 3
    assert (planes.distances < 0).sum() == filtered.sum()


def test_without_displacements_the_surface_is_between_the_sides():
    occupied = GRID.centroids[:, 0] < 0.5
    field = Field(occupied, np.zeros((len(occupied), 3), dtype=np.float32))
    planes = planes_of_field(field, GRID, occupied)
    points = np.array([[0.1, 0.5, 0.5], [0.9, 0.5, 0.5], [0.5, 0.4, 0.4]])
    low, high, middle = planes.distance(points)
    assert low < -0.01
    assert high == pytest.approx(-low)
    assert abs(middle) < abs(low)


def test_solids_end_at_the_wall_of_the_cube():
    field = plane_field(np.array([0.0, 1.0, 0.0]), 2.0)  # all of the cube lies inside
    planes = planes_of_field(field, GRID, field.occupancy)
    np.testing.assert_allclose(
        planes.distance(np.array([[0.5, 1.2, 0.5], [0.5, 0.9, 0.5]])), [0.2, -0.1], atol=1e-6
    )
    assert planes.project(np.array([[0.5, 1.2, 0.5]]), 1.0).max() <= 1


def test_the_planes_of_one_side_do_not_make_the_other_thicker():
    # A slab thinner than a tet: weights by the centroids alone put it out by a fifth of that.
    half = 0.06
    height = GRID.centroids[:, 2] - 0.52
    to_surface = np.zeros_like(GRID.centroids)
    to_surface[:, 2] = np.where(height < 0, -half, half) - height
    occupied = np.abs(height) < half
    planes = planes_of_field(Field(occupied, to_surface.astype(np.float32)), GRID, occupied)
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(0.2, 0.8, (400, 2)), 0.52 + half * rng.choice([-1, 1], 400)])
    assert np.abs(planes.distance(points)).mean() < 0.1 * half


def test_a_centroid_on_the_surface_takes_its_neighbours_normal():
    tet = int(np.abs(GRID.centroids[:, 0] - 0.5).argmin())
    field = plane_field(np.array([1.0, 0.0, 0.0]), float(GRID.centroids[tet, 0]))
    field.displacement[tet] = [0.0, 1e-8, 0.0]  # rounding, which points anywhere
    planes = planes_of_field(field, GRID, field.occupancy)
    np.testing.assert_allclose(planes.normals[tet], [1.0, 0.0, 0.0], atol=1e-6)
