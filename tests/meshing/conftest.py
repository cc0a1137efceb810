"""Grids and fields that the meshing tests share."""

import numpy as np
import pytest

from tetgan.fields.field import Field, vertex_operator
from tetgan.grids.hierarchy import build_hierarchy


@pytest.fixture(scope="session")
def grid():
    return build_hierarchy(2, 1).finest


@pytest.fixture(scope="session")
def fine_grid():
    return build_hierarchy(2, 2).finest


@pytest.fixture(scope="session")
def operator(grid):
    return vertex_operator(grid)


@pytest.fixture(scope="session")
def make_field(grid):
    """A field from a seed: a random share of the tets, displaced by a few hundredths."""

    def make(seed, share=0.5):
        rng = np.random.default_rng(seed)
        displacement = rng.normal(scale=0.02, size=(len(grid.tets), 3)).astype(np.float32)
        return Field(rng.random(len(grid.tets)) < share, displacement)

    return make
