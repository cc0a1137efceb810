"""Grids and analytic surfaces that the field tests share."""

import numpy as np
import pytest
import trimesh

from tetgan.grids.hierarchy import build_hierarchy


@pytest.fixture(scope="session")
def hierarchy():
    return build_hierarchy(2, 1)


@pytest.fixture(scope="session")
def ball():
    """Vertices and faces of a ball of radius 0.4 about the centre of the cube."""
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.4)
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64)
