"""Elements of degree 2 on a curved surface: their Jacobians, and the volume they gain."""

import igl
import numpy as np
import pytest
import skfem
import trimesh

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.tets import tet_volumes
from tetgan.geometry.triangles import TriangleMesh
from tetgan.solids.curving import curve_onto, jacobian_coefficients
from tetgan.solids.elements import MIDDLES, quadratic_elements
from tetgan.solids.export import write_tets
from tetgan.solids.solid import SolidMesh


@pytest.fixture(scope="module")
def ball():
    """A ball of radius 1 in tets whose boundary vertices lie on the sphere."""
    mesh = skfem.MeshTet.init_ball(3)
    vertices, tets = np.ascontiguousarray(mesh.p.T), mesh.t.T.astype(np.int64)
    turned = tet_volumes(vertices, tets) < 0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    return SolidMesh(vertices, tets, boundary_faces(tets))


@pytest.fixture(scope="module")
def sphere():
    mesh = trimesh.creation.icosphere(5)
    return TriangleMesh(np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int64))


def jacobians(points, weights):
    """By the shape functions of textbooks, at barycentric coordinates."""
    slopes = np.array([[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])  # of the barycentric coordinates
    at_corners = (4 * weights - 1)[:, None] * slopes
    one, other = MIDDLES.T
    at_middles = 4 * (weights[one, None] * slopes[other] + weights[other, None] * slopes[one])
    return np.linalg.det(np.einsum("tnc,nd->tcd", points, np.concatenate([at_corners, at_middles])))


@pytest.mark.parametrize("seed", range(5))
def test_the_coefficients_are_of_the_jacobian_and_bound_it(ball, seed):
    generator = np.random.default_rng(seed)
    points = quadratic_elements(ball).nodes[quadratic_elements(ball).cells[:50]]
    points = points + generator.normal(0, 0.05, points.shape)
    found = jacobian_coefficients(points)
    for corner, weights in enumerate(np.eye(4)):  # at a corner the coefficient is the value
        place = [0, 10, 16, 19][corner]
        np.testing.assert_allclose(found[:, place], jacobians(points, weights), rtol=1e-9, atol=1e-12)
    for weights in generator.dirichlet(np.ones(4), 50):
        value = jacobians(points, weights)
        assert (value >= found.min(axis=1) - 1e-12).all() and (value <= found.max(axis=1) + 1e-12).all()


def test_straight_tets_have_six_volumes_everywhere(ball):
    elements = quadratic_elements(ball)
    found = jacobian_coefficients(elements.nodes[elements.cells])
    np.testing.assert_allclose(found, np.tile(6 * ball.volumes[:, None], 20), rtol=1e-10)


def test_a_curved_ball_has_the_volume_of_a_ball(tmp_path, ball, sphere):
    straight = quadratic_elements(ball)
    curved = curve_onto(straight, sphere)
    middles = np.unique(straight.faces[:, 3:])
    assert curved.moved == len(middles) and curved.straight == 0
    assert np.array_equal(curved.elements.cells, straight.cells)
    inner = np.setdiff1d(np.arange(len(straight.nodes)), middles)
    assert np.array_equal(curved.elements.nodes[inner], straight.nodes[inner])
    coefficients = jacobian_coefficients(curved.elements.nodes[curved.elements.cells])
    volume, exact = coefficients.mean() * len(coefficients) / 6, 4 / 3 * np.pi
    assert 1 - ball.volumes.sum() / exact > 0.02  # of flat faces
    assert volume == pytest.approx(exact, rel=2e-3)


def test_gmsh_finds_the_curved_jacobians_positive(tmp_path, ball, sphere):
    gmsh = pytest.importorskip("gmsh", reason="gmsh is no dependency")
    curved = curve_onto(quadratic_elements(ball), sphere).elements
    write_tets(tmp_path / "a.msh", curved)
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "a.msh"))
        _, (tets,), _ = gmsh.model.mesh.getElements(3)
        least = np.array(gmsh.model.mesh.getElementQualities(tets, "minDetJac"))
        places, weights = gmsh.model.mesh.getIntegrationPoints(11, "Gauss3")
        _, values, _ = gmsh.model.mesh.getJacobians(11, places)
        volumes = values.reshape(len(tets), -1) @ weights
    finally:
        gmsh.finalize()
    coefficients = jacobian_coefficients(curved.nodes[curved.cells])
    assert (least > 0).all() and (coefficients.min(axis=1) <= least + 1e-9).all()
    np.testing.assert_allclose(coefficients.mean(axis=1) / 6, volumes, rtol=1e-9)


def test_where_a_tet_would_fold_its_edges_stay_straight(ball, sphere):
    """Half of the sphere is pushed in so far that its tets would turn over."""
    deep = sphere.vertices.copy()
    deep[deep[:, 1] > 0.5] *= 0.5
    straight = quadratic_elements(ball)
    curved = curve_onto(straight, TriangleMesh(deep, sphere.faces))
    assert curved.moved > 0 and curved.straight > 0
    middles = np.unique(straight.faces[:, 3:])
    assert curved.moved + curved.straight == len(middles)
    assert (jacobian_coefficients(curved.elements.nodes[curved.elements.cells]) > 0).all()
    kept = (curved.elements.nodes == straight.nodes).all(axis=1)[middles]
    distance, *_ = igl.point_mesh_squared_distance(curved.elements.nodes[middles], deep, sphere.faces)
    assert (kept | (distance < 1e-20)).all() and kept.sum() == curved.straight


def test_inverted_tets_stay_as_they_are(ball, sphere):
    turned = ball.tets[:, [1, 0, 2, 3]]
    straight = quadratic_elements(SolidMesh(ball.vertices, turned, boundary_faces(turned)))
    curved = curve_onto(straight, sphere)
    assert curved.moved == 0 and np.array_equal(curved.elements.nodes, straight.nodes)
