"""Occupancy and displacement against closed forms and brute force."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.fields.extraction import _regions, extract_field, extract_graded
from tetgan.fields.field import surface_tets
from tetgan.grids.hierarchy import build_hierarchy, subdivide_lattice
from tetgan.grids.lattice import cube_lattice, open_lattice


def distance_to_triangle(points, a, b, c):
    """Distances of (P, 3) points to a triangle: to its sides and, where they project inside, its plane."""
    distances = []
    for start, end in ((a, b), (b, c), (c, a)):
        share = np.clip((points - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
        distances.append(np.linalg.norm(start + share[:, None] * (end - start) - points, axis=1))
    basis = np.stack([b - a, c - a], axis=1)
    inside = np.linalg.lstsq(basis, (points - a).T, rcond=None)[0]
    height = np.linalg.norm(a + (basis @ inside).T - points, axis=1)
    within = (inside >= 0).all(axis=0) & (inside.sum(axis=0) <= 1)
    return np.minimum.reduce([*distances, np.where(within, height, np.inf)])


def distance_to_mesh(points, vertices, faces):
    return np.minimum.reduce([distance_to_triangle(points, *corners) for corners in vertices[faces]])


def winding_number(points, vertices, faces):
    """Sum of signed solid angles, van Oosterom and Strackee (1983)."""
    total = np.zeros(len(points))
    for corners in vertices[faces]:
        a, b, c = (corner - points for corner in corners)
        la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
        dots = (np.sum(a * b, axis=1) * lc, np.sum(b * c, axis=1) * la, np.sum(c * a, axis=1) * lb)
        total += 2 * np.arctan2(np.sum(a * np.cross(b, c), axis=1), la * lb * lc + sum(dots))
    return total / (4 * np.pi)


def closed_soup(seed):
    """A few boxes, turned at random, that may overlap: closed, but neither simple nor connected."""
    rng = np.random.default_rng(seed)
    parts = []
    for _ in range(3):
        part = trimesh.creation.box(rng.uniform(0.1, 0.5, 3))
        part.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
        parts.append(part.apply_translation(rng.uniform(0.35, 0.65, 3)))
    mesh = trimesh.util.concatenate(parts)
    return np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=10, deadline=None)
def test_every_tet_agrees_with_brute_force(seed):
    grid = build_hierarchy(2, 1).finest
    vertices, faces = closed_soup(seed)
    field = extract_field(vertices, faces, grid)
    np.testing.assert_array_equal(field.occupancy, winding_number(grid.centroids, vertices, faces) > 0.5)
    # The closest point itself may be one of several; its distance is not. float32 holds 6e-8 of it.
    distance = distance_to_mesh(grid.centroids, vertices, faces)
    np.testing.assert_allclose(np.linalg.norm(field.displacement, axis=1), distance, rtol=1e-6, atol=1e-7)
    assert distance_to_mesh(grid.centroids + field.displacement, vertices, faces).max() < 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_the_surface_passes_through_no_region(seed):
    grid = build_hierarchy(2, 2).finest
    vertices, faces = closed_soup(seed)
    distances = np.linalg.norm(extract_field(vertices, faces, grid).displacement, axis=1)
    asked, region = _regions(distances, grid)
    np.testing.assert_array_equal(region[asked], np.arange(len(asked)))
    assert (distances <= distances[asked][region]).all()
    inside = winding_number(grid.centroids, vertices, faces) > 0.5
    np.testing.assert_array_equal(inside, inside[asked][region])
    assert len(asked) < len(grid.tets) / 4


def test_a_ball_has_a_closed_form(grid, ball):
    field = extract_field(*ball, grid)
    offset = grid.centroids - 0.5
    radius = np.linalg.norm(offset, axis=1)
    # The polyhedron stays within 0.4 and 0.4 cos(edge/2): 0.0022 below the ball at 1,280 faces.
    clear = np.abs(radius - 0.4) > 0.003
    np.testing.assert_array_equal(field.occupancy[clear], (radius < 0.4)[clear])
    assert np.abs(np.linalg.norm(field.displacement, axis=1) - np.abs(radius - 0.4)).max() < 0.003
    assert field.displacement.dtype == np.float32


def test_a_box_is_exact(grid):
    mesh = trimesh.creation.box((0.6, 0.6, 0.6))
    field = extract_field(np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64), grid)
    reach = np.abs(grid.centroids - 0.5) - 0.3
    np.testing.assert_array_equal(field.occupancy, reach.max(axis=1) < 0)
    outside = np.linalg.norm(reach.clip(min=0), axis=1)
    distance = np.where(field.occupancy, -reach.max(axis=1), outside)
    np.testing.assert_allclose(np.linalg.norm(field.displacement, axis=1), distance, atol=1e-7)


def rows_of(grid):
    """Tets by the coordinates of their corners."""
    return {tet.tobytes(): row for row, tet in enumerate(grid.vertices[grid.tets])}


@pytest.mark.parametrize("interior", ["graded", "fine"])
@pytest.mark.parametrize(
    ("lattice", "seed", "reach"),
    [(cube_lattice, 0, 1.0), (cube_lattice, 2, 2.0), (open_lattice, 0, 1.0), (open_lattice, 1, 0.5)],
)
def test_a_graded_field_is_that_of_the_dense_grid(lattice, interior, seed, reach):
    base = lattice(2)
    dense = subdivide_lattice(base, 3).finest
    vertices, faces = closed_soup(seed)
    grid, field = extract_graded(vertices, faces, base, 3, reach=reach, interior=interior)
    expected = extract_field(vertices, faces, dense)

    # Of both grids, every tet with a vertex near the surface, which is of the finest level.
    known, where = rows_of(grid), []
    for mesh in (dense, grid):
        near = distance_to_mesh(mesh.vertices, vertices, faces) <= reach * base.longest_edge / 32
        where.append(np.flatnonzero(near[mesh.tets].any(axis=1)))
    there, here = where
    assert (grid.level[here] == 3).all()
    assert not grid.green[here].any()
    assert len(grid.tets) < len(dense.tets)
    rows = [known[tet.tobytes()] for tet in dense.vertices[dense.tets[there]]]
    assert set(rows) == set(here.tolist())
    np.testing.assert_array_equal(field.occupancy[rows], expected.occupancy[there])
    np.testing.assert_array_equal(field.displacement[rows], expected.displacement[there])

    # Further off the field is exact at the grid's own centroids, but for displacements in a fine interior.
    np.testing.assert_array_equal(field.occupancy, winding_number(grid.centroids, vertices, faces) > 0.5)
    distance = distance_to_mesh(grid.centroids, vertices, faces)
    exact = ~(field.occupancy & (distance > reach * base.longest_edge / 32) & (interior == "fine"))
    length = np.linalg.norm(field.displacement, axis=1)
    np.testing.assert_allclose(length[exact], distance[exact], rtol=1e-6, atol=1e-7)
    assert (length > distance * (1 - 1e-6) - 1e-7).all()
    assert distance_to_mesh(grid.centroids + field.displacement, vertices, faces).max() < 1e-6


@pytest.mark.parametrize("lattice", [cube_lattice, open_lattice])
def test_a_fine_interior_is_that_of_the_dense_grid(lattice, ball):
    base = lattice(2)
    dense = subdivide_lattice(base, 3).finest
    grid, field = extract_graded(*ball, base, 3, interior="fine")
    inside = extract_field(*ball, dense).occupancy
    assert rows_of(grid).keys() >= {tet.tobytes() for tet in dense.vertices[dense.tets[inside]]}
    assert (grid.level[field.occupancy] == 3).all()
    assert np.count_nonzero(field.occupancy) == np.count_nonzero(inside)
    coarse, coarse_field = extract_graded(*ball, base, 3)
    assert coarse_field.occupancy[coarse.level < 3].any()
    assert len(coarse.tets) < len(grid.tets)


def test_a_mesh_without_faces_is_refused(grid):
    with pytest.raises(ValueError, match="without faces"):
        extract_field(np.zeros((3, 3)), np.zeros((0, 3), dtype=np.int64), grid)
    with pytest.raises(ValueError, match="without faces"):
        extract_graded(np.zeros((3, 3)), np.zeros((0, 3), dtype=np.int64), cube_lattice(1), 1)


def test_surface_tets_agree_with_a_loop(grid):
    occupancy = np.random.default_rng(0).random(len(grid.tets)) < 0.7
    for tet, on_surface in enumerate(surface_tets(occupancy, grid.neighbors)):
        open_side = any(other < 0 or not occupancy[other] for other in grid.neighbors[tet])
        assert on_surface == (occupancy[tet] and open_side)


def test_a_full_grid_has_its_surface_at_the_wall(grid):
    full = np.ones(len(grid.tets), dtype=bool)
    np.testing.assert_array_equal(surface_tets(full, grid.neighbors), (grid.neighbors < 0).any(axis=1))
    assert not surface_tets(~full, grid.neighbors).any()
