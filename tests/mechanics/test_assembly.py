"""Stiffness, forces and stresses against exact answers and against scikit-fem's own elasticity."""

import numpy as np
import pytest
import skfem
from skfem.models.elasticity import linear_elasticity

from tetgan.geometry.tets import TetMesh
from tetgan.mechanics.assembly import (
    Body,
    face_weights,
    rigid_motions,
    stiffness,
    stresses,
    to_vertices,
    volume_weights,
    von_mises,
)
from tetgan.mechanics.options import Material

STUFF = Material(young=1e9, poisson=0.3, density=1000)
ORDERS = pytest.mark.parametrize("order", [1, 2])


@ORDERS
def test_the_stiffness_is_that_of_a_vector_element(crooked, order):
    body = Body(*crooked, order)
    element = skfem.ElementVector(body.basis.elem)
    theirs = linear_elasticity(*STUFF.lame).assemble(skfem.Basis(body.mesh, element, intorder=2))
    ours = stiffness(body, STUFF)
    basis = skfem.Basis(body.mesh, element, intorder=2)
    # The same work along the same displacements, whatever the numbering: sin is no shape function.
    fields = [lambda x, k=k: np.sin([1 * x[0] + k, 2 * x[1], x[2] + k * x[0]]) for k in range(3)]
    vectors = [_interpolated(basis, field) for field in fields]
    nodal = [field(body.nodes.T).T.ravel() for field in fields]
    for one, mine in zip(vectors, nodal, strict=True):
        for other, yours in zip(vectors, nodal, strict=True):
            assert mine @ (ours @ yours) == pytest.approx(one @ (theirs @ other), rel=1e-10, abs=1e-3)


def _interpolated(basis, field):
    """Values of a field at the unknowns of a vector element: each belongs to one component at one place."""
    values = field(basis.doflocs)
    found = np.empty(basis.N)
    for component in range(3):
        dofs = basis.split_indices()[component]
        found[dofs] = values[component, dofs]
    return found


@ORDERS
def test_rigid_motions_cost_nothing(crooked, order):
    body = Body(*crooked, order)
    matrix, motions = stiffness(body, STUFF), rigid_motions(body.nodes)
    # Rounding: the entries of the matrix are up to 1e9 and each sum has about a hundred.
    assert np.abs(matrix @ motions).max() < 1e-12 * np.abs(matrix.data).max() * 100
    assert np.linalg.matrix_rank(motions) == 6
    assert abs(matrix - matrix.T).max() < 1e-12 * np.abs(matrix.data).max()


@ORDERS
def test_a_linear_displacement_has_one_stress_everywhere(crooked, order):
    body = Body(*crooked, order)
    gradient = np.array([[1e-3, 2e-3, 0], [0, -3e-4, 5e-4], [1e-4, 0, 7e-4]])
    found = stresses(body, STUFF, body.nodes @ gradient.T)
    first, shear = STUFF.lame
    expected = first * np.trace(gradient) * np.eye(3) + shear * (gradient + gradient.T)
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=1e-9, atol=1e-3)


@ORDERS
def test_weights_sum_to_area_and_volume(crooked, order):
    body = Body(*crooked, order)
    weights = volume_weights(body)
    assert weights.sum() == pytest.approx(1)
    assert weights @ body.nodes == pytest.approx([0.5, 0.5, 0.5])
    faces = body.boundary_faces(1.0)
    top = faces.normals[:, 1] > 0.99
    assert face_weights(body, top).sum() == pytest.approx(1)
    assert face_weights(body, top) @ body.nodes == pytest.approx([0.5, 1, 0.5])
    on_top = np.unique(np.flatnonzero(np.isclose(body.nodes[:, 1], 1)))
    assert np.array_equal(body.nodes_of(top), on_top)


def test_normals_point_outward(crooked):
    faces = Body(*crooked, 1).boundary_faces(1.0)
    # Of the unit cube, the outward normal is the axis along which a face lies at 0 or at 1.
    at_end = np.isclose(faces.middles, 1).astype(float) - np.isclose(faces.middles, 0)
    np.testing.assert_allclose(faces.normals, at_end, atol=1e-12)


def test_von_mises_of_known_states():
    pull, shear, squeeze = np.diag([5.0, 0, 0]), np.zeros((3, 3)), -4 * np.eye(3)
    shear[0, 1] = shear[1, 0] = 2.0
    assert von_mises(np.stack([pull, shear, squeeze])) == pytest.approx([5, 2 * np.sqrt(3), 0])


def test_vertex_means_are_weighed_by_volume():
    # Two tets on one face, the second of twice the height of the first.
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -2.0]])
    solid = TetMesh(vertices, np.array([[0, 1, 2, 3], [0, 2, 1, 4]]))
    found = to_vertices(Body(*solid, 1), np.array([3.0, 6.0]))
    assert found == pytest.approx([5, 5, 5, 3, 6])
