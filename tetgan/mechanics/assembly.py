"""Finite elements on a tet mesh, by scikit-fem: nodes, stiffness, forces, stresses.

Unknowns are numbered node by node, x, y, z of each. Vector equations are put together from scalar forms, nine
products of derivatives in all, which is several times quicker than a vector element.
"""

import logging
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import skfem
from jaxtyping import Bool, Float, Int
from scipy import sparse
from skfem.element import ElementTetP1, ElementTetP2

from tetgan.geometry.tets import TetMesh
from tetgan.mechanics.materials import Material
from tetgan.solids.regions import BoundaryFaces, faces_of_tets

logging.getLogger("skfem").setLevel(logging.WARNING)  # else it tells of every basis and form

_ELEMENTS = {1: ElementTetP1, 2: ElementTetP2}


@dataclass(frozen=True, eq=False)
class Body(TetMesh):
    """A mesh and its elements, of degree 1 or 2.

    Attributes:
        vertices: (V, 3) in metres.
        tets: (T, 4), all positive.
        order: degree of the elements; those of degree 2 have a node at the middle of each edge too.
    """

    order: int

    @cached_property
    def mesh(self) -> skfem.MeshTet:
        return skfem.MeshTet(np.ascontiguousarray(self.vertices.T), np.ascontiguousarray(self.tets.T))

    @cached_property
    def basis(self) -> skfem.CellBasis:
        return skfem.CellBasis(self.mesh, _ELEMENTS[self.order](), intorder=2 * (self.order - 1))

    @property
    def nodes(self) -> Float[np.ndarray, "N 3"]:
        """Places of the nodes, the vertices first."""
        return self.basis.doflocs.T

    @cached_property
    def boundary(self) -> Int[np.ndarray, "F"]:
        """Numbers of scikit-fem's faces that have a tet on one side only."""
        return self.mesh.boundary_facets()

    def boundary_faces(self, size: float) -> BoundaryFaces:
        """The same faces as regions choose from them, in mesh units of `size` metres."""
        corners = self.vertices[self.mesh.facets[:, self.boundary].T] / size
        tets = self.vertices[self.tets[self.mesh.f2t[0, self.boundary]]] / size
        return faces_of_tets(corners, tets)

    def nodes_of(self, chosen: Bool[np.ndarray, "F"]) -> Int[np.ndarray, "M"]:
        """Nodes on some of the boundary faces."""
        return self.basis.get_dofs(self.boundary[chosen]).flatten().astype(np.int64)


def stiffness(body: Body, material: Material) -> sparse.bsr_array:
    """Symmetric matrix of 3 by 3 blocks, one for each pair of nodes that share a tet.

    Its product with a displacement is the force that holds the body in that shape, in newtons.
    """
    first, shear = material.lame
    products = [[_product(body.basis, i, j) for j in range(3)] for i in range(3)]
    pattern = products[0][0]
    traces = products[0][0].data + products[1][1].data + products[2][2].data
    blocks = np.empty((len(pattern.data), 3, 3))
    for i in range(3):
        for j in range(3):
            blocks[:, i, j] = first * products[i][j].data + shear * products[j][i].data
        blocks[:, i, i] += shear * traces
    count = 3 * pattern.shape[0]
    return sparse.bsr_array((blocks, pattern.indices, pattern.indptr), shape=(count, count))


def _product(basis: skfem.CellBasis, i: int, j: int) -> sparse.csr_array:
    """Integrals of the derivative along i of one shape function times that along j of another.

    All nine have one pattern: what cancels to zero stays in it.
    """
    form = skfem.BilinearForm(lambda u, v, _: v.grad[i] * u.grad[j])
    entries = form.elemental(basis)
    matrix = sparse.coo_array((entries.data, tuple(entries.indices)), shape=entries.shape).tocsr()
    matrix.sort_indices()
    return matrix


def face_weights(body: Body, chosen: Bool[np.ndarray, "F"]) -> Float[np.ndarray, "N"]:
    """Integral of each shape function over some of the boundary faces; the sum is their area."""
    faces = skfem.FacetBasis(body.mesh, body.basis.elem, facets=body.boundary[chosen])
    return _integrals(faces)


def volume_weights(body: Body) -> Float[np.ndarray, "N"]:
    """Integral of each shape function over the body; the sum is its volume."""
    return _integrals(skfem.CellBasis(body.mesh, body.basis.elem, intorder=body.order))


def _integrals(basis: skfem.CellBasis | skfem.FacetBasis) -> Float[np.ndarray, "N"]:
    return skfem.LinearForm(lambda v, _: v).assemble(basis)


def rigid_motions(points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "M 6"]:
    """Translations along x, y, z and small turns about them, as displacements of points; columns.

    Turns are about the points' middle, by their radius: every column is of the order of one.
    """
    centred = points - points.mean(axis=0)
    x, y, z = (centred / (np.abs(centred).max() or 1.0)).T
    motions = np.zeros((len(points), 3, 6))
    motions[:, range(3), range(3)] = 1
    motions[:, 1, 3], motions[:, 2, 3] = -z, y
    motions[:, 0, 4], motions[:, 2, 4] = z, -x
    motions[:, 0, 5], motions[:, 1, 5] = -y, x
    return motions.reshape(-1, 6)


def stresses(
    body: Body, material: Material, displacement: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "T 3 3"]:
    """Stress in the middle of each tet, which is its mean over the tet, in Pa."""
    first, shear = material.lame
    middle = skfem.CellBasis(body.mesh, body.basis.elem, intorder=1)
    slopes = [middle.interpolate(np.ascontiguousarray(u)).grad[:, :, 0] for u in displacement.T]
    gradient = np.moveaxis(np.stack(slopes), 2, 0)
    strain = (gradient + gradient.swapaxes(1, 2)) / 2
    return 2 * shear * strain + first * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(3)


def von_mises(stress: Float[np.ndarray, "T 3 3"]) -> Float[np.ndarray, "T"]:
    """The uniaxial stress that distorts as much: sqrt(3/2) times the norm of the deviator."""
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))


def to_vertices(body: Body, values: Float[np.ndarray, "T"]) -> Float[np.ndarray, "V"]:
    """Mean over the tets around each vertex, weighed by their volumes."""
    edges = body.vertices[body.tets[:, 1:]] - body.vertices[body.tets[:, :1]]
    volumes = np.repeat(np.abs(np.linalg.det(edges)), 4)
    corners, count = body.tets.ravel(), len(body.vertices)
    total = np.bincount(corners, volumes * np.repeat(values, 4), minlength=count)
    return total / np.maximum(np.bincount(corners, volumes, minlength=count), np.finfo(float).tiny)
