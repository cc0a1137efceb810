"""The base lattice: counts and volumes by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.grids.lattice import cube_lattice


@given(cells=st.integers(1, 7))
@settings(max_examples=7, deadline=None)
def test_counts_follow_from_the_cells(cells):
    grid = cube_lattice(cells)
    # 3 n²(n-1) inner faces and 6 n² at the wall, four tets each.
    assert len(grid.tets) == 4 * (3 * cells**2 * (cells - 1) + 6 * cells**2)
    # Corners of cells, their centres, centres of the faces at the wall.
    assert len(grid.vertices) == (cells + 1) ** 3 + cells**3 + 6 * cells**2


@given(cells=st.integers(1, 7))
@settings(max_examples=7, deadline=None)
def test_the_cube_is_filled_exactly(cells):
    grid = cube_lattice(cells)
    # Volumes in half-cell units are whole numbers of sixths, so rounding them loses nothing.
    sixths = grid.volumes * 6 * (2 * cells) ** 3
    np.testing.assert_allclose(sixths, np.rint(sixths), atol=1e-9)
    assert np.rint(sixths).sum() == 6 * (2 * cells) ** 3
    assert grid.volumes.min() > 0
    assert grid.vertices.min() == 0
    assert grid.vertices.max() == 1


@pytest.mark.parametrize(("cells", "ratio"), [(1, 1), (2, 2), (3, 2)])
def test_tets_at_the_wall_are_half_as_large(cells, ratio):
    volumes = cube_lattice(cells).volumes
    assert volumes.max() / volumes.min() == pytest.approx(ratio, rel=1e-12)


def test_one_cell_is_the_cube_cut_towards_its_centre():
    grid = cube_lattice(1)
    assert len(grid.tets) == 24
    centre = np.flatnonzero((grid.vertices == 0.5).all(axis=1))
    assert (grid.tets == centre).any(axis=1).all()
