"""Solids cut open by a plane."""

import numpy as np
import pytest
import trimesh

from tetgan.geometry.tets import TetMesh
from tetgan.rendering.meshes import cut_solid
from tetgan.rendering.raycast import STEEL, render_mesh

# A unit cube as six tets around its diagonal (Kuhn), positively oriented.
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
KUHN = np.array([[0, 4, 6, 7], [0, 6, 2, 7], [0, 2, 3, 7], [0, 3, 1, 7], [0, 1, 5, 7], [0, 5, 4, 7]])


def row_of_cubes(count: int) -> TetMesh:
    """Kuhn cubes side by side along x, their shared corners welded."""
    vertices = np.concatenate([CORNERS + np.array([i, 0, 0]) for i in range(count)])
    tets = np.concatenate([KUHN + 8 * i for i in range(count)])
    unique, index = np.unique(vertices, axis=0, return_inverse=True)
    return TetMesh(unique, index.reshape(-1)[tets])


def test_an_uncut_solid_is_its_skin_in_one_colour():
    cut = cut_solid(row_of_cubes(3), np.array([1.0, 0, 0]), 99.0)
    mesh = trimesh.Trimesh(cut.vertices, cut.faces, process=False)
    assert mesh.is_watertight and mesh.volume == pytest.approx(3.0)
    assert (cut.colors == np.array(STEEL)).all()


def test_a_cut_keeps_the_tets_behind_the_plane_and_paints_what_it_opens():
    cut = cut_solid(row_of_cubes(3), np.array([2.0, 0, 0]), 2.0)
    mesh = trimesh.Trimesh(cut.vertices, cut.faces, process=False)
    # One cube of three stays: 10 triangles of skin and the 2 of the opened side, at x = 1.
    assert mesh.is_watertight and mesh.volume == pytest.approx(1.0) and len(cut.faces) == 12
    opened = (cut.colors != np.array(STEEL)).any(axis=1)
    assert opened.sum() == 2
    assert (cut.triangles[opened][..., 0] == 1).all()


def test_a_plane_before_everything_leaves_nothing():
    cut = cut_solid(row_of_cubes(2), np.array([1.0, 0, 0]), -1.0)
    assert len(cut.faces) == len(cut.colors) == 0


def test_the_cut_shows_in_a_picture():
    cut = cut_solid(row_of_cubes(3), np.array([1.0, 0, 0]), 1.0)
    image = render_mesh(
        cut.vertices, cut.faces, size=(60, 60), azimuth=90, elevation=0, colors=cut.colors
    ).astype(int)
    red, _, blue = image[30, 30]
    assert red > blue
