"""The lattice around a surface: fine where it has to be, its distance decided everywhere."""

import numpy as np
import pytest

from tetgan.fields.field import Field
from tetgan.geometry.adjacency import face_neighbors
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.background import lattice_around, subdivisions
from tetgan.meshing.planes import planes_of_field

GRID = build_hierarchy(2, 1).finest
NOTHING = np.empty((0, 3))


def planes_of_ball(radius):
    from_centre = GRID.centroids - 0.5
    length = np.linalg.norm(from_centre, axis=1, keepdims=True)
    field = Field(length[:, 0] < radius, (from_centre * (radius / length - 1)).astype(np.float32))
    return planes_of_field(field, GRID, field.occupancy)


def crossed_and_around(grid, distances):
    """Tets of both signs, and all within two rings of their vertices."""
    near = np.zeros(len(distances), dtype=bool)
    near[grid.tets[np.ptp((distances < 0)[grid.tets].astype(int), axis=1) > 0]] = True
    near[grid.tets[near[grid.tets].any(axis=1)]] = True
    return near[grid.tets].any(axis=1)


@pytest.mark.parametrize("interior", ["fine", "graded"])
def test_a_ball_has_fine_tets_around_its_surface(interior):
    grid, distances = lattice_around(planes_of_ball(0.35), NOTHING, 16, interior)
    around = crossed_and_around(grid, distances)
    assert around.any()
    assert (grid.level[around] == 4).all()
    assert not grid.green[around].any()
    from_centre = np.linalg.norm(grid.vertices - 0.5, axis=1)
    clear = np.abs(from_centre - 0.35) > 0.05
    np.testing.assert_array_equal(distances[clear] < 0, from_centre[clear] < 0.35)


def test_a_graded_interior_has_fewer_tets():
    fine, graded = (lattice_around(planes_of_ball(0.45), NOTHING, 32, each) for each in ("fine", "graded"))
    inside = [(distances[grid.tets] < 0).all(axis=1).sum() for grid, distances in (fine, graded)]
    assert inside[1] < 0.9 * inside[0]
    occupied = (fine[1][fine[0].tets] < 0).all(axis=1)
    assert (fine[0].level[occupied] == fine[0].level.max()).all()


@pytest.mark.parametrize("seed", range(3))
def test_noise_is_fine_wherever_it_changes_sides(seed):
    rng = np.random.default_rng(seed)
    occupied = rng.random(len(GRID.tets)) < 0.5
    displacement = rng.normal(scale=2.0, size=(len(occupied), 3)).astype(np.float32)  # no foot is nearby
    planes = planes_of_field(Field(occupied, displacement), GRID, occupied)
    grid, distances = lattice_around(planes, NOTHING, 8, "graded")
    around = crossed_and_around(grid, distances)
    assert around.any()
    assert (grid.level[around] == grid.level.max()).all()
    assert not grid.green[around].any()


def test_the_hull_is_outside_and_no_vertex_is_on_the_surface():
    planes = planes_of_ball(0.9)  # all of the cube
    grid, distances = lattice_around(planes, NOTHING, 8, "fine")
    hull = np.unique(grid.tets[(face_neighbors(grid.tets) < 0).any(axis=1)])
    assert ((grid.vertices[hull] < -0.2) | (grid.vertices[hull] > 1.2)).any(axis=1).all()
    assert (distances[hull] > 0).all()
    assert (distances != 0).all()
    assert (distances < 0).any()


@pytest.mark.parametrize(("cells", "expected"), [(5, 0), (6, 1), (12, 2), (24, 3), (64, 4)])
def test_subdivisions_of_a_coarser_lattice(cells, expected):
    assert subdivisions(cells) == expected
    assert (cells >> expected) << expected == cells
