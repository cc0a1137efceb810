"""Surfaces of functions with known ones; the octree against evaluating everything."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tetgan.meshing.marching import mise, voxel_surface
from tetgan.solids.record import surface_record


def sphere(points, radius=0.35):
    return radius - np.linalg.norm(points - 0.5, axis=1)


def torus(points):
    x, y, z = (points - 0.5).T
    return 0.12 - np.hypot(np.hypot(x, z) - 0.3, y)


class Waves:
    """A smooth random function, with lumps far smaller than the coarse cells."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        self.waves, self.phases = rng.normal(0, 12, (3, 20)), rng.uniform(0, 6, 20)

    def __call__(self, points):
        return np.sin(points @ self.waves + self.phases).sum(axis=1)


def assert_same(got, want):
    np.testing.assert_array_equal(got.faces, want.faces)
    np.testing.assert_array_equal(got.vertices, want.vertices)


@pytest.mark.parametrize("value", [sphere, torus])
@pytest.mark.parametrize("level", [0.0, -0.02])
def test_the_octree_gives_the_mesh_of_a_dense_grid(value, level):
    evaluated = []

    def counted(points):
        evaluated.append(len(points))
        return value(points)

    assert_same(mise(counted, 8, 3, level), mise(value, 64, 0, level))
    assert sum(evaluated) < 0.25 * 65**3


def test_a_surface_is_followed_out_of_the_cells_where_it_was_seen():
    # A rod along the diagonal, thinner than the coarse cells: only a few of the coarse points are inside.
    def rod(points):
        along = (points - 0.5) @ np.ones(3) / 3
        return 0.03 - np.linalg.norm(points - 0.5 - along[:, None], axis=1)

    assert_same(mise(rod, 4, 4, 0.0), mise(rod, 64, 0, 0.0))


@given(seed=st.integers(0, 2**32 - 1))
@example(seed=4335)
@settings(max_examples=10, deadline=None)
def test_what_the_octree_finds_of_any_function_is_closed_and_part_of_the_dense_surface(seed):
    waves = Waves(seed)
    got, dense = mise(waves, 8, 2, 1.0), mise(waves, 32, 0, 1.0)
    assert surface_record(got)["manifold_edges"] == 1
    # Within the box: at the wall the octree closes over a dent too small to be seen.
    found, all_of_it = (
        {tuple(row) for row in np.round(s.vertices, 6) if np.abs(row - 0.5).max() <= 0.5}
        for s in (got, dense)
    )
    assert found <= all_of_it


def test_the_sphere_is_a_sphere_facing_outward():
    surface = mise(sphere, 16, 2, 0.0)
    radius = np.linalg.norm(surface.vertices - 0.5, axis=1)
    # Linear interpolation along an edge of h = 1/64 misses the radius by up to h²/8r.
    assert np.abs(radius - 0.35).max() < (1 / 64) ** 2 / (8 * 0.35) * 1.5
    record = surface_record(surface)
    assert record["volume"] == pytest.approx(4 / 3 * np.pi * 0.35**3, rel=0.005)
    assert (record["components"], record["manifold_edges"]) == (1, 1.0)


def test_the_box_is_where_it_is_said_to_be():
    surface = mise(lambda points: sphere(points, 0.52), 44, 0, 0.0, box=1.1)
    radius = np.linalg.norm(surface.vertices - 0.5, axis=1)
    assert np.abs(radius - 0.52).max() < 2e-4  # (1/40)² / (8 · 0.52)


def test_axes_are_in_order():
    def ellipsoid(points):
        return 1 - np.linalg.norm((points - 0.5) / np.array([0.4, 0.3, 0.2]), axis=1)

    for surface in (
        mise(ellipsoid, 32, 0, 0.0),
        voxel_surface(-ellipsoid(centres(32)).reshape(32, 32, 32).astype(np.float32)),
    ):
        extent = np.ptp(surface.vertices, axis=0)
        np.testing.assert_allclose(extent, [0.8, 0.6, 0.4], atol=0.01)


def centres(resolution):
    along = (np.arange(resolution) + 0.5) / resolution
    return np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3)


def test_voxels_of_a_sphere():
    distance = -sphere(centres(32)).reshape(32, 32, 32).astype(np.float32)
    for level, radius in ((0.0, 0.35), (0.05, 0.4)):
        surface = voxel_surface(distance, level)
        assert np.abs(np.linalg.norm(surface.vertices - 0.5, axis=1) - radius).max() < 5e-4
        assert surface_record(surface)["volume"] > 0


def test_what_fills_the_cube_is_closed_at_its_wall():
    surface = voxel_surface(np.full((8, 8, 8), -0.1, dtype=np.float32))
    assert surface.vertices.min() == 0
    assert surface.vertices.max() == 1
    assert surface_record(surface)["manifold_edges"] == 1
    half = mise(lambda points: 0.5 - points[:, 0], 8, 1, 0.0)
    record = surface_record(half)
    assert record["manifold_edges"] == 1
    # Up to half a cell of 1/16 beyond the wall, but for the edges cut off.
    assert record["volume"] == pytest.approx((0.5 + 1 / 32) * (1 + 1 / 16) ** 2, rel=0.02)


def test_nothing_inside_is_no_faces():
    for surface in (mise(lambda points: -np.ones(len(points)), 4, 1, 0.0), voxel_surface(np.ones((4, 4, 4)))):
        assert surface.faces.shape == (0, 3)
        assert surface_record(surface) == {"faces": 0, "volume": 0, "components": 0, "manifold_edges": 0}
