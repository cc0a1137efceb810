"""What tests of several rooms share."""

import numpy as np
import pytest

from tetgan.rendering.sheet import contact_sheet


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests of one file stay in one process, where they share what they have made."""
    for item in items:
        if item.get_closest_marker("xdist_group") is None:
            item.add_marker(pytest.mark.xdist_group(item.path.stem))


@pytest.fixture
def cells(monkeypatch) -> list[np.ndarray]:
    """The pictures of the sheet that is drawn next, row by row."""
    seen: list[np.ndarray] = []

    def spy(images, columns, **titles):
        seen[:] = images
        return contact_sheet(images, columns, **titles)

    monkeypatch.setattr("tetgan.rendering.figure.contact_sheet", spy)
    return seen
