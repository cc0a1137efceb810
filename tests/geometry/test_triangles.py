"""Volume, components and joining of triangle meshes, against boxes and tori that are counted by hand."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from tetgan.geometry.boundary import Boundary, shell_volumes
from tetgan.geometry.triangles import TriangleMesh, area_normals, join_meshes


def made(mesh: trimesh.Trimesh, offset: float = 0.0) -> TriangleMesh:
    return TriangleMesh(np.array(mesh.vertices) + offset, np.array(mesh.faces, dtype=np.int64))


BOX = made(trimesh.creation.box((1.0, 2.0, 3.0)))
NOTHING = TriangleMesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))


@given(st.floats(-100, 100))
def test_a_box_has_its_volume_wherever_it_is_and_minus_that_inside_out(offset):
    moved = TriangleMesh(BOX.vertices + offset, BOX.faces)
    assert moved.volume == pytest.approx(6)
    assert TriangleMesh(moved.vertices, moved.faces[:, ::-1]).volume == pytest.approx(-6)


def test_a_polyhedral_torus_has_the_volume_of_its_rings():
    # Pappus for a ring of prisms: of n sections, of area a about a circle of radius r, sin(2 pi / n) n r a.
    sections, sides = 40, 24
    torus = made(trimesh.creation.torus(0.32, 0.1, sections, sides))
    euler = len(np.unique(torus.faces)) - len(Boundary(torus.faces)._edges[0]) + len(torus.faces)
    assert euler == 0  # genus 1
    assert abs(torus.volume) == pytest.approx(2 * np.pi**2 * 0.32 * 0.1**2, rel=0.03)
    assert abs(torus.volume) < 2 * np.pi**2 * 0.32 * 0.1**2  # its corners are on the round one


def test_joined_meshes_add_up_and_a_void_takes_away():
    inner = TriangleMesh(0.5 * BOX.vertices, BOX.faces[:, ::-1])
    far = TriangleMesh(BOX.vertices + 10, BOX.faces)
    joined = join_meshes([BOX, inner, far])
    assert joined.volume == pytest.approx(6 - 6 / 8 + 6)
    assert joined.components == 3
    np.testing.assert_array_equal(joined.triangles, np.concatenate([m.triangles for m in (BOX, inner, far)]))
    shells = Boundary(joined.faces).shells(joined.vertices)
    np.testing.assert_allclose(shell_volumes(joined.vertices, joined.faces, shells), [6, -6 / 8, 6])


def test_nothing_has_no_volume_and_no_components():
    assert join_meshes([]).faces.shape == (0, 3)
    assert NOTHING.volume == 0
    assert NOTHING.components == 0


def test_components_are_joined_by_vertices_and_unused_vertices_do_not_count():
    bow_tie = TriangleMesh(np.random.default_rng(0).random((9, 3)), np.array([[1, 2, 3], [3, 4, 5]]))
    assert bow_tie.components == 1
    assert TriangleMesh(bow_tie.vertices, np.array([[1, 2, 3], [6, 4, 5]])).components == 2


def test_area_normals_are_twice_as_long_as_the_areas():
    triangle = np.array([[[0.0, 0, 0], [3, 0, 0], [0, 4, 0]]])
    np.testing.assert_array_equal(area_normals(triangle), [[0, 0, 12]])
    np.testing.assert_array_equal(area_normals(triangle[None, :, ::-1]), [[[0, 0, -12]]])
