"""Bars of tets, made by code."""

import numpy as np
import pytest
import skfem

from tetgan.geometry.tets import TetMesh, tet_volumes


def positive(vertices: np.ndarray, tets: np.ndarray) -> TetMesh:
    turned = tet_volumes(vertices, tets) < 0
    tets = tets.copy()
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    return TetMesh(vertices, tets)


@pytest.fixture(scope="session")
def bar():
    """A bar along x with a square section, in cubes of five tets."""

    def make(along: int, across: int, length: float = 1.0, side: float = 0.1) -> TetMesh:
        x, y = np.linspace(0, length, along + 1), np.linspace(0, side, across + 1)
        mesh = skfem.MeshTet.init_tensor(x, y, y)
        return positive(np.ascontiguousarray(mesh.p.T), mesh.t.T.astype(np.int64))

    return make


@pytest.fixture(scope="session")
def crooked(bar):
    """A cube of tets with its inner vertices moved about, so that no two tets are alike."""
    solid = bar(4, 4, length=1.0, side=1.0)
    vertices = solid.vertices.copy()
    inner = ((vertices > 0) & (vertices < 1)).all(axis=1)
    vertices[inner] += np.random.default_rng(0).uniform(-0.04, 0.04, (int(inner.sum()), 3))
    assert (tet_volumes(vertices, solid.tets) > 0).all()
    return TetMesh(vertices, solid.tets)
