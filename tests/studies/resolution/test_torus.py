"""The exact torus against points on it, closed forms, and the fields of a mesh of it."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import KDTree

from tetgan.fields.extraction import extract_field
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.studies.resolution.torus import Torus


def test_distance_is_that_to_the_nearest_of_many_points_on_it(torus):
    on_surface = torus.mesh(600, 300).vertices
    points = np.random.default_rng(0).random((2000, 3))
    sampled, _ = KDTree(on_surface).query(points)
    exact = np.abs(torus.signed_distance(points))
    assert (sampled >= exact - 1e-12).all()  # the nearest point of all is no further than any of some
    spacing = 2 * np.pi * np.hypot(0.42 / 600, 0.12 / 300) / 2
    assert (sampled <= exact + spacing).all()


def test_distance_has_a_sign_and_known_values():
    upright = Torus(major=0.3, minor=0.1, axis=(0.0, 0.0, 1.0))
    points = np.array([[0.5, 0.5, 0.5], [0.8, 0.5, 0.5], [0.95, 0.5, 0.5], [0.8, 0.5, 0.75]])
    np.testing.assert_allclose(upright.signed_distance(points), [0.2, -0.1, 0.05, 0.15], atol=1e-15)


def test_closest_points_lie_on_it_at_the_distance(torus):
    points = np.random.default_rng(1).random((1000, 3))
    closest = torus.closest_points(points)
    np.testing.assert_allclose(torus.signed_distance(closest), 0, atol=1e-14)
    np.testing.assert_allclose(
        np.linalg.norm(closest - points, axis=1), np.abs(torus.signed_distance(points)), atol=1e-14
    )


def test_on_the_axis_and_in_the_middle_of_the_tube_any_nearest_point_will_do():
    upright = Torus(major=0.3, minor=0.1, axis=(0.0, 0.0, 1.0))
    points = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 0.7], [0.8, 0.5, 0.5]])
    closest = upright.closest_points(points)
    np.testing.assert_allclose(upright.signed_distance(closest), 0, atol=1e-14)
    np.testing.assert_allclose(
        np.linalg.norm(closest - points, axis=1), [0.2, np.hypot(0.3, 0.2) - 0.1, 0.1], atol=1e-14
    )


def test_samples_are_uniform_by_area(torus):
    count = 200_000
    drawn = torus.sample(count, seed=0)
    np.testing.assert_allclose(torus.signed_distance(drawn), 0, atol=1e-14)
    radius = np.linalg.norm(np.cross(drawn - 0.5, np.array(torus.axis) / np.sqrt(14)), axis=1)
    outer = 0.5 + torus.minor / (np.pi * torus.major)  # share of the area further out than the ring
    assert (radius > torus.major).mean() == pytest.approx(outer, abs=4 * 0.5 / np.sqrt(count))
    np.testing.assert_allclose(drawn.mean(axis=0), 0.5, atol=4 * 0.3 / np.sqrt(count))
    np.testing.assert_array_equal(drawn, torus.sample(count, seed=0))


def test_its_mesh_is_closed_and_faces_outward(torus):
    surface = torus.mesh(120, 60)
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert mesh.is_watertight
    # A circle of n chords loses (2 pi / n)^2 / 6 of its area; here both circles do.
    assert mesh.volume == pytest.approx(2 * np.pi**2 * torus.major * torus.minor**2, rel=0.005)
    assert mesh.area == pytest.approx(4 * np.pi**2 * torus.major * torus.minor, rel=0.005)


def test_its_field_is_that_of_a_fine_mesh(torus):
    grid = build_hierarchy(2, 1).finest
    surface, exact = torus.mesh(400, 200), torus.field(grid.centroids)
    extracted = extract_field(surface.vertices, surface.faces, grid)
    sagitta = 0.42 * (2 * np.pi / 400) ** 2 / 8 + 0.12 * (2 * np.pi / 200) ** 2 / 8
    clear = np.abs(torus.signed_distance(grid.centroids)) > sagitta
    np.testing.assert_array_equal(exact.occupancy[clear], extracted.occupancy[clear])
    assert 0 < exact.occupancy.mean() < 0.2
    lengths = [np.linalg.norm(field.displacement, axis=1) for field in (exact, extracted)]
    np.testing.assert_allclose(*lengths, atol=2 * sagitta)
