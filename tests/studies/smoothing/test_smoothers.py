"""Each smoothing against its formula, and their invariants."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from tetgan.fields.extraction import extract_field
from tetgan.fields.field import Field, vertex_operator
from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.triangles import TriangleMesh
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.solids.record import quality_record
from tetgan.studies.smoothing.smoothers import SMOOTHERS, VARIANTS, Variant, build_variants


def wls_weight(vertices, displacement, faces, one, other):
    lengths = np.linalg.norm(displacement[one]) * np.linalg.norm(displacement[other])
    return abs(displacement[one] @ displacement[other]) / lengths if lengths else 0.0


def uniform_weight(vertices, displacement, faces, one, other):
    return 1.0


def cotangent_weight(vertices, displacement, faces, one, other):
    total = 0.0
    for face in faces.tolist():
        if one in face and other in face:
            (apex,) = set(face) - {one, other}
            a, b = vertices[one] - vertices[apex], vertices[other] - vertices[apex]
            total += (a @ b) / np.linalg.norm(np.cross(a, b)) / 2
    return max(total, 0.0)


WEIGHTS = {"wls": wls_weight, "uniform": uniform_weight, "cotangent": cotangent_weight}


def naive_step(weight, vertices, displacement, faces, beta):
    smoothed = vertices.copy()
    for vertex in range(len(vertices)):
        around = {int(other) for face in faces if vertex in face for other in face} - {vertex}
        weights = {other: weight(vertices, displacement, faces, vertex, other) for other in around}
        if total := sum(weights.values()):
            mean = sum(w * vertices[other] for other, w in weights.items()) / total
            smoothed[vertex] = beta * vertices[vertex] + (1 - beta) * mean
    return smoothed


@pytest.mark.parametrize("name", SMOOTHERS)
@pytest.mark.parametrize("seed", range(3))
def test_it_agrees_with_a_loop(name, seed):
    rng = np.random.default_rng(seed)
    grid = build_hierarchy(1, 0).finest
    faces = boundary_faces(grid.tets[rng.random(len(grid.tets)) < 0.5])
    vertices = grid.vertices + rng.normal(scale=0.05, size=grid.vertices.shape)
    displacement = rng.normal(size=vertices.shape)
    smoothed = SMOOTHERS[name](vertices, displacement, faces, 0.3)
    np.testing.assert_allclose(
        smoothed, naive_step(WEIGHTS[name], vertices, displacement, faces, 0.3), atol=1e-12
    )


@pytest.mark.parametrize("name", SMOOTHERS)
def test_a_flat_patch_stays_flat(name):
    rng = np.random.default_rng(0)
    flat = rng.random((40, 2))
    faces = Delaunay(flat).simplices.astype(np.int64)
    normal = np.array([0.3, -0.5, 1.0])
    vertices = np.column_stack([flat, (0.7 - flat @ normal[:2]) / normal[2]])
    smoothed = SMOOTHERS[name](vertices, rng.normal(size=(40, 3)), faces, 0.5)
    np.testing.assert_allclose(smoothed @ normal, 0.7, atol=1e-12)
    assert np.abs(smoothed - vertices).max() > 0.01


@pytest.mark.parametrize("name", SMOOTHERS)
def test_a_ball_shrinks(name, ball):
    vertices, faces = ball
    inward = 0.01 * (0.5 - vertices)
    smoothed = SMOOTHERS[name](vertices, inward, faces, 0.5)
    before, after = (TriangleMesh(places, faces).volume for places in (vertices, smoothed))
    assert 0.9 * before < after < before
    np.testing.assert_allclose(smoothed.mean(axis=0), 0.5, atol=1e-3)


@pytest.mark.parametrize("name", SMOOTHERS)
def test_beta_one_and_no_faces_change_nothing(name, ball):
    vertices, faces = ball
    np.testing.assert_array_equal(SMOOTHERS[name](vertices, vertices - 0.5, faces, 1.0), vertices)
    np.testing.assert_array_equal(SMOOTHERS[name](vertices, vertices - 0.5, faces[:0], 0.5), vertices)


def test_triangles_without_area_leave_cotangents_finite():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 0, 0], [0.5, 1, 0], [0, 0, 0]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [2, 1, 3], [0, 4, 3]])
    assert np.isfinite(SMOOTHERS["cotangent"](vertices, vertices, faces, 0.5)).all()


@pytest.fixture(scope="module")
def grid():
    return build_hierarchy(2, 1).finest


@pytest.fixture(scope="module")
def operator(grid):
    return vertex_operator(grid)


def test_variants_are_those_that_samples_are_made_of(grid, operator, ball):
    field, options = extract_field(*ball, grid), MeshingOptions.parse({"mode": "paper"})
    for mu in (0.001, 1.0):  # the first filters surface tets away
        solids = build_variants(field, grid, operator, mu, options)
        assert list(solids) == list(VARIANTS)
        for smoothing, name in ((False, "none"), (True, "wls")):
            solid = build_solid(field, grid, operator, mu, options, smoothing=smoothing)
            np.testing.assert_array_equal(solids[Variant(True, name)].tets, solid.tets)
            np.testing.assert_allclose(solids[Variant(True, name)].vertices, solid.vertices, atol=1e-9)


def test_blocky_variants_stand_on_the_lattice_and_all_share_their_faces(grid, operator, ball):
    solids = build_variants(extract_field(*ball, grid), grid, operator, 1.0, MeshingOptions.parse({}))
    blocky = solids[Variant(False, "none")]
    lattice = {tuple(place) for place in grid.vertices.tolist()}
    assert {tuple(place) for place in blocky.vertices.tolist()} <= lattice
    assert quality_record(blocky)["inverted_tets"] == 0
    for solid in solids.values():
        np.testing.assert_array_equal(solid.faces, blocky.faces)
    volumes = {variant.name: quality_record(solid)["volume"] for variant, solid in solids.items()}
    for base in ("blocky", "displaced"):
        assert all(volumes[f"{base}-{name}"] < volumes[f"{base}-none"] for name in SMOOTHERS)


def test_an_empty_field_has_empty_variants(grid, operator):
    nothing = Field(np.zeros(len(grid.tets), dtype=bool), np.zeros((len(grid.tets), 3), dtype=np.float32))
    solids = build_variants(nothing, grid, operator, 1.0, MeshingOptions.parse({}))
    assert all(len(solid.faces) == 0 for solid in solids.values())
