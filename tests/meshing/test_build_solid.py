"""A field becomes a solid: which vertices move, where to, and the odd fields."""

import time
from collections import Counter

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tetgan.fields.extraction import extract_field
from tetgan.fields.field import Field, VertexField, vertex_operator
from tetgan.geometry.tets import tet_volumes
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.build import build_solid
from tetgan.meshing.filtering import filter_occupancy
from tetgan.meshing.options import MeshingOptions

PAPER = MeshingOptions(mode="paper")
FAR = 1.0  # a mu at which the filter keeps everything
fixtures_are_constant = settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def still(occupancy):
    return Field(occupancy, np.zeros((len(occupancy), 3), dtype=np.float32))


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0, 1), mu=st.floats(0.005, 0.02))
@fixtures_are_constant
def test_the_solid_has_the_tets_that_pass_the_filter(*, seed, share, mu, grid, operator, make_field):
    field = make_field(seed, share)
    mesh = build_solid(field, grid, operator, mu, PAPER, smoothing=False)
    kept = grid.tets[filter_occupancy(field, grid.neighbors, mu, PAPER.gamma)]
    used = np.unique(kept)
    np.testing.assert_array_equal(used[mesh.tets], kept)
    assert len(mesh.vertices) == len(used)
    assert mesh.vertices.dtype == np.float64


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0, 1), smoothing=st.booleans())
@fixtures_are_constant
def test_faces_are_the_sides_with_one_tet(*, seed, share, smoothing, grid, operator, make_field):
    mesh = build_solid(make_field(seed, share), grid, operator, FAR, PAPER, smoothing=smoothing)
    sides = Counter(frozenset(np.delete(tet, slot).tolist()) for tet in mesh.tets for slot in range(4))
    once = {side for side, count in sides.items() if count == 1}
    assert len(mesh.faces) == len(once)
    assert {frozenset(face) for face in mesh.faces.tolist()} == once


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.1, 1))
@fixtures_are_constant
def test_faces_enclose_the_tets(seed, share, grid, operator, make_field):
    mesh = build_solid(make_field(seed, share), grid, operator, FAR, PAPER, smoothing=True)
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    # Divergence theorem; holds for inverted tets too, since both sides count signed volume.
    enclosed = np.einsum("fc,fc->", a, np.cross(b, c)) / 6
    assert enclosed == pytest.approx(tet_volumes(mesh.vertices, mesh.tets).sum(), abs=1e-12)


def test_only_boundary_vertices_move_and_by_equation_3(grid, operator, make_field):
    field = make_field(0, 0.9)
    mesh = build_solid(field, grid, operator, FAR, PAPER, smoothing=False)
    used = np.unique(grid.tets[field.occupancy])
    moved = mesh.vertices - grid.vertices[used]
    boundary = np.isin(np.arange(len(used)), mesh.faces)
    assert 0 < boundary.sum() < len(used)
    np.testing.assert_array_equal(moved[~boundary], 0)
    np.testing.assert_allclose(moved[boundary], (operator @ field.displacement)[used][boundary], atol=1e-9)


@pytest.mark.parametrize("smoothing", [False, True])
def test_displacements_at_vertices_move_them_as_eq_3_would(grid, operator, make_field, smoothing):
    field = make_field(0, 0.9)
    at_vertices = VertexField(field.occupancy, (operator @ field.displacement).astype(np.float32))
    one, other = (
        build_solid(each, grid, operator, FAR, PAPER, smoothing=smoothing) for each in (field, at_vertices)
    )
    np.testing.assert_allclose(one.vertices, other.vertices, atol=1e-8)  # float32 of some hundredths
    np.testing.assert_array_equal(one.tets, other.tets)


def test_smoothing_does_nothing_without_displacement(grid, operator, make_field):
    # The weights of Eq. 4 are cosines of displacements, so occupancy alone is never smoothed.
    field = still(make_field(0, 0.9).occupancy)
    rough, smooth = (build_solid(field, grid, operator, FAR, PAPER, smoothing=on) for on in (False, True))
    np.testing.assert_array_equal(rough.vertices, smooth.vertices)


def test_smoothing_leaves_the_inside_alone(grid, operator, make_field):
    field = make_field(0, 0.9)
    rough, smooth = (build_solid(field, grid, operator, FAR, PAPER, smoothing=on) for on in (False, True))
    boundary = np.isin(np.arange(len(rough.vertices)), rough.faces)
    np.testing.assert_array_equal(rough.vertices[~boundary], smooth.vertices[~boundary])
    assert (rough.vertices[boundary] != smooth.vertices[boundary]).any(axis=1).mean() > 0.9


@pytest.mark.parametrize("smoothing", [False, True])
def test_an_empty_field_is_an_empty_solid(grid, operator, smoothing):
    mesh = build_solid(
        still(np.zeros(len(grid.tets), dtype=bool)), grid, operator, FAR, PAPER, smoothing=smoothing
    )
    assert (len(mesh.vertices), len(mesh.tets), len(mesh.faces)) == (0, 0, 0)


@pytest.mark.parametrize("smoothing", [False, True])
def test_one_tet_is_itself(grid, operator, smoothing):
    occupancy = np.arange(len(grid.tets)) == 7
    mesh = build_solid(still(occupancy), grid, operator, FAR, PAPER, smoothing=smoothing)
    assert (len(mesh.vertices), len(mesh.tets), len(mesh.faces)) == (4, 1, 4)
    np.testing.assert_array_equal(mesh.vertices[mesh.tets[0]], grid.vertices[grid.tets[7]])


def test_a_full_field_is_the_closed_cube(grid, operator):
    mesh = build_solid(
        still(np.ones(len(grid.tets), dtype=bool)), grid, operator, FAR, PAPER, smoothing=False
    )
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert surface.is_watertight
    assert surface.is_winding_consistent
    assert surface.volume == pytest.approx(1, abs=1e-12)
    assert surface.area == pytest.approx(6, abs=1e-12)


def test_the_same_field_gives_the_same_bits(grid, operator, make_field):
    one, other = (build_solid(make_field(3), grid, operator, 0.02, PAPER, smoothing=True) for _ in range(2))
    assert one.vertices.tobytes() == other.vertices.tobytes()
    assert one.faces.tobytes() == other.faces.tobytes()


def test_a_shape_takes_a_tenth_of_a_second():
    grid = build_hierarchy(2, 3).finest
    operator = vertex_operator(grid)
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.45)
    field = extract_field(np.array(ball.vertices) + 0.5, np.array(ball.faces, dtype=np.int64), grid)
    build_solid(field, grid, operator, FAR, PAPER, smoothing=True)  # the neighbours are found once
    start = time.process_time()
    build_solid(field, grid, operator, FAR, PAPER, smoothing=True)
    assert time.process_time() - start < 0.1
