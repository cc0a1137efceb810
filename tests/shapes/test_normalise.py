"""Shapes in the unit cube."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tetgan.shapes.normalise import normalise


@settings(deadline=None)
@given(
    vertices=hnp.arrays(np.float64, (6, 3), elements=st.floats(-1e3, 1e3)).filter(
        lambda v: np.ptp(v, axis=0).max() > 1e-3
    ),
    margin=st.floats(0, 0.4),
)
def test_box_is_centred_and_its_longest_side_is_what_the_margins_leave(
    vertices: np.ndarray, margin: float
) -> None:
    placed = normalise(vertices, margin)
    low, high = placed.min(axis=0), placed.max(axis=0)
    # 1e3 / 1e-3 of magnification times the rounding of float64
    np.testing.assert_allclose((low + high) / 2, 0.5, atol=1e-9)
    assert (high - low).max() == pytest.approx(1 - 2 * margin, abs=1e-9)


def test_a_box_by_hand() -> None:
    placed = normalise(np.array([[1.0, 1.0, 1.0], [5.0, 3.0, 2.0]]), margin=0.1)
    np.testing.assert_allclose(placed, [[0.1, 0.3, 0.4], [0.9, 0.7, 0.6]], atol=1e-15)


def test_a_point_and_too_wide_a_margin_are_refused() -> None:
    with pytest.raises(ValueError, match="span"):
        normalise(np.ones((4, 3)), margin=0.0)
    with pytest.raises(ValueError, match="margin"):
        normalise(np.eye(3), margin=0.5)
