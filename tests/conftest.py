"""Fixtures and options shared by all tests."""

import numpy as np
import pytest
from xdist.scheduler import LoadScopeScheduling

from tetgan.fields.field import Field, vertex_operator
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.rendering.sheet import contact_sheet


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The workflow first: beside its long run the other process gets through the rest."""
    items.sort(key=lambda item: item.path.parent.name != "workflow")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> LoadScopeScheduling:
    return Together(config, log)


class Together(LoadScopeScheduling):
    """Tests of one file stay in one process, where they share what they have made; so do all of the workflow.

    The marks of xdist itself (`--dist loadgroup`) do nothing under pytest 9.2, which takes no other node ids.
    """

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.partition("::")[0]
        return "workflow" if "/workflow/" in file else file


@pytest.fixture
def cells(monkeypatch) -> list[np.ndarray]:
    """The pictures of the sheet that is drawn next, row by row."""
    seen: list[np.ndarray] = []

    def spy(images, columns, **titles):
        seen[:] = images
        return contact_sheet(images, columns, **titles)

    monkeypatch.setattr("tetgan.rendering.figure.contact_sheet", spy)
    return seen


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
