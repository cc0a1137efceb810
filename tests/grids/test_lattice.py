"""The base lattice: counts and volumes by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.grids.lattice import cube_lattice, open_lattice


@given(cells=st.integers(1, 7))
@settings(max_examples=7, deadline=None)
def test_counts_follow_from_the_cells(cells):
    grid = cube_lattice(cells).grid
    # 3 n²(n-1) inner faces and 6 n² at the wall, four tets each.
    assert len(grid.tets) == 4 * (3 * cells**2 * (cells - 1) + 6 * cells**2)
    # Corners of cells, their centres, centres of the faces at the wall.
    assert len(grid.vertices) == (cells + 1) ** 3 + cells**3 + 6 * cells**2


@given(cells=st.integers(1, 7))
@settings(max_examples=7, deadline=None)
def test_the_cube_is_filled_exactly(cells):
    grid = cube_lattice(cells).grid
    # Volumes in half-cell units are whole numbers of sixths, so rounding them loses nothing.
    sixths = grid.volumes * 6 * (2 * cells) ** 3
    np.testing.assert_allclose(sixths, np.rint(sixths), atol=1e-9)
    assert np.rint(sixths).sum() == 6 * (2 * cells) ** 3
    assert grid.volumes.min() > 0
    assert grid.vertices.min() == 0
    assert grid.vertices.max() == 1


@pytest.mark.parametrize(("cells", "ratio"), [(1, 1), (2, 2), (3, 2)])
def test_tets_at_the_wall_are_half_as_large(cells, ratio):
    volumes = cube_lattice(cells).grid.volumes
    assert volumes.max() / volumes.min() == pytest.approx(ratio, rel=1e-12)


def test_one_cell_is_the_cube_cut_towards_its_centre():
    grid = cube_lattice(1).grid
    assert len(grid.tets) == 24
    centre = np.flatnonzero((grid.vertices == 0.5).all(axis=1))
    assert (grid.tets == centre).any(axis=1).all()


@pytest.mark.parametrize(("cells", "margin"), [(1, 1), (2, 1), (3, 1), (2, 2)])
def test_an_open_lattice_has_whole_tets_around_the_faces_between_cells(cells, margin):
    lattice = open_lattice(cells, margin)
    side = cells + 2 * margin
    assert len(lattice.tets) == 4 * 3 * side**2 * (side - 1)
    assert len(np.unique(np.sort(lattice.tets, axis=1), axis=0)) == len(lattice.tets)
    # A twelfth of a cell each, which is 8 cubed half cells.
    np.testing.assert_allclose(lattice.grid.volumes * lattice.unit**3, 8 / 12, rtol=1e-12)
    assert (lattice.points.min(axis=0) == -2 * margin).all()
    assert (lattice.points.max(axis=0) == 2 * (cells + margin)).all()
    edges = lattice.points[lattice.grid.edges]
    assert np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1).max() == lattice.longest_edge


@given(cells=st.integers(1, 5))
@settings(max_examples=5, deadline=None)
def test_an_open_lattice_has_the_whole_tets_of_the_cube(cells):
    lattice, cube = open_lattice(cells), cube_lattice(cells)
    assert lattice.unit == cube.unit
    corners = lattice.points[lattice.tets]
    inside = ((corners >= 0) & (corners <= lattice.unit)).all(axis=(1, 2))
    whole = cube.grid.volumes * cube.unit**3 > 0.5
    np.testing.assert_array_equal(corners[inside], cube.points[cube.tets[whole]])


@given(point=st.tuples(*[st.floats(0, 1)] * 3), cells=st.integers(1, 3))
@settings(max_examples=30, deadline=None)
def test_an_open_lattice_covers_the_cube(point, cells):
    grid = open_lattice(cells).grid
    a, b, c, d = np.moveaxis(grid.vertices[grid.tets], 1, 0)
    shares = np.linalg.solve(np.stack([b - a, c - a, d - a], axis=2), (point - a)[..., None])[..., 0]
    assert ((shares > -1e-12).all(axis=1) & (shares.sum(axis=1) < 1 + 1e-12)).any()
