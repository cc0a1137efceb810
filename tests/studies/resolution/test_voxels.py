"""Marching cubes in blocks, against the voxels themselves and a ball."""

import numpy as np
import pytest

from tetgan.geometry.tets import tet_volumes
from tetgan.studies.resolution import voxels
from tetgan.studies.resolution.voxels import voxel_surfaces

RADIUS = 0.37


def ball_distance(points):
    return np.linalg.norm(points - 0.5, axis=1) - RADIUS


def volume(vertices, faces, apex):
    tets = np.column_stack([np.full(len(faces), len(vertices)), faces])
    return tet_volumes(np.vstack([vertices, apex]), tets).sum()


@pytest.mark.parametrize("resolution", [20, 31, 33, 64])
def test_surfaces_are_closed_and_hold_a_ball(resolution):
    for surface in voxel_surfaces(ball_distance, resolution):
        here, there = (volume(surface.vertices, surface.faces, np.full(3, place)) for place in (0.0, 7.0))
        assert here == pytest.approx(there)  # only a closed surface has a volume wherever one looks from
        assert here == pytest.approx(4 / 3 * np.pi * RADIUS**3, rel=2 / resolution)


def test_distances_put_vertices_on_the_ball_to_second_order():
    for resolution in (16, 32, 64):
        vertices = voxel_surfaces(ball_distance, resolution).distance.vertices
        # Along an edge of length 1/n a distance of curvature 1/r bends away from its chord by 1/(8 r n^2).
        assert np.abs(ball_distance(vertices)).max() < 1.05 / (8 * RADIUS * resolution**2)


def test_binary_vertices_are_the_middles_between_inside_and_outside():
    resolution = 21
    vertices = voxel_surfaces(ball_distance, resolution).binary.vertices
    halves = np.rint(2 * resolution * vertices)
    np.testing.assert_allclose(2 * resolution * vertices, halves, atol=1e-9)
    found = {tuple(place) for place in halves.astype(int).tolist()}
    expected = set()
    cells = [(x, y, z) for x in range(resolution) for y in range(resolution) for z in range(resolution)]
    inside = {cell for cell in cells if ball_distance((np.array([cell]) + 0.5) / resolution)[0] < 0}
    for x, y, z in inside:
        for dx, dy, dz in [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]:
            if (x + dx, y + dy, z + dz) not in inside:
                expected.add((2 * x + 1 + dx, 2 * y + 1 + dy, 2 * z + 1 + dz))
    assert found == expected


def test_blocky_surface_is_that_of_the_cubes_inside():
    resolution = 21
    blocky = voxel_surfaces(ball_distance, resolution).blocky
    axis = (np.arange(resolution) + 0.5) / resolution
    centres = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = (ball_distance(centres) < 0).reshape((resolution,) * 3)
    assert volume(blocky.vertices, blocky.faces, np.zeros(3)) == pytest.approx(inside.sum() / resolution**3)
    sides = sum(int(np.diff(inside.astype(int), axis=axis).astype(bool).sum()) for axis in range(3))
    assert len(blocky.faces) == 2 * sides
    corners = blocky.triangles
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    np.testing.assert_allclose(areas, 0.5 / resolution**2)


def test_blocks_leave_no_trace(monkeypatch):
    whole = voxel_surfaces(ball_distance, 24)
    monkeypatch.setattr(voxels, "_BLOCK", 5)
    for one, other in zip(whole, voxel_surfaces(ball_distance, 24), strict=True):
        assert len(one.faces) == len(other.faces)
        triangles = [np.sort(np.round(m.triangles, 9).reshape(-1, 9), axis=1) for m in (one, other)]
        np.testing.assert_array_equal(*[t[np.lexsort(t.T)] for t in triangles])


def test_nothing_inside_is_no_surface():
    for surface in voxel_surfaces(lambda points: np.ones(len(points)), 8):
        assert surface.vertices.shape == (0, 3)
        assert surface.faces.shape == (0, 3)
