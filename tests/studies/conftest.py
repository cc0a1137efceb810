"""Shapes that several tests of the studies share."""

import numpy as np
import pytest
import trimesh

from tetgan.studies.torus import Torus


@pytest.fixture(scope="session")
def torus():
    return Torus(major=0.3, minor=0.12, axis=(1.0, 2.0, 3.0))


@pytest.fixture(scope="session")
def ball():
    """Vertices and faces of a ball of radius 0.4 about the middle of the cube."""
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=0.4)
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64)


@pytest.fixture(scope="session")
def cube():
    """Vertices and faces of the unit cube, two triangles a side."""
    mesh = trimesh.creation.box((1, 1, 1))
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64)
