"""The space around a grid: filled without overlap, and a ball around every vertex of the grid."""

import numpy as np
import pytest

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.tets import tet_volumes
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.collared_grid import collared_grid


@pytest.mark.parametrize(("cells", "depth"), [(1, 0), (1, 2), (2, 1), (3, 0)])
def test_grid_and_collar_fill_a_larger_cube(cells, depth):
    grid = build_hierarchy(cells, depth).finest
    ambient = collared_grid(grid)
    volumes = tet_volumes(ambient.vertices, ambient.tets)
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(1.25**3, abs=1e-12)
    assert ambient.guarded.all()
    np.testing.assert_array_equal(ambient.tets[: len(grid.tets)], grid.tets)
    # Only the outside of the collar is a boundary, and only it is pinned.
    np.testing.assert_array_equal(np.unique(boundary_faces(ambient.tets)), np.flatnonzero(ambient.pinned))
    np.testing.assert_array_equal(
        np.flatnonzero(ambient.pinned), np.arange(len(grid.vertices), len(ambient.vertices))
    )


def test_it_is_made_once_a_grid(grid):
    assert collared_grid(grid) is collared_grid(grid)


def test_a_grid_that_is_not_star_shaped_keeps_its_wall():
    cube = build_hierarchy(2, 1).finest
    middle = cube.centroids - 0.5
    bent = TetGrid(cube.vertices, cube.tets[(middle[:, 0] < -0.2) | (middle[:, 1] < -0.2)])  # an L
    ambient = collared_grid(bent)
    assert ambient.pinned[np.unique(boundary_faces(bent.tets))].all()
    assert not ambient.guarded[len(bent.tets) :].any()


@pytest.mark.parametrize("kind", ["vertices", "edges"])
def test_pieces_are_those_of_a_flood_fill(grid, kind):
    ambient = collared_grid(grid)
    members = ambient.tets if kind == "vertices" else ambient.edges_of_tets
    around = ambient.around_vertices if kind == "vertices" else ambient.around_edges
    occupancy = ambient.with_collar(np.random.default_rng(0).random(len(grid.tets)) < 0.5)
    simplices = np.unique(members[: len(grid.tets)])[::7]
    counts = around.pieces(simplices, None, occupancy).counts(len(simplices))
    for simplex, (empty, occupied) in zip(simplices, counts, strict=True):
        tets = np.flatnonzero((members == simplex).any(axis=1))
        corners = set(ambient.tets[tets[0]]).intersection(*(ambient.tets[tet] for tet in tets))
        assert _flood(ambient, {t for t in tets if occupancy[t]}, corners) == occupied
        assert _flood(ambient, {t for t in tets if not occupancy[t]}, corners) == empty


def _flood(ambient, tets, corners):
    """Pieces of some tets, joined by the faces that hold all of some corners."""
    pieces = 0
    while tets:
        pieces, front = pieces + 1, [tets.pop()]
        while front:
            one = set(ambient.tets[front.pop()])
            beside = {
                t
                for t in tets
                if len(one & set(ambient.tets[t])) == 3 and corners <= one & set(ambient.tets[t])
            }
            tets -= beside
            front += beside
    return pieces
