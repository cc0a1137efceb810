"""What tests of several rooms share."""

import numpy as np
import pytest

from tetgan.rendering.sheet import contact_sheet


@pytest.fixture
def cells(monkeypatch) -> list[np.ndarray]:
    """The pictures of the sheet that is drawn next, row by row."""
    seen: list[np.ndarray] = []

    def spy(images, columns, **titles):
        seen[:] = images
        return contact_sheet(images, columns, **titles)

    monkeypatch.setattr("tetgan.rendering.figure.contact_sheet", spy)
    return seen
