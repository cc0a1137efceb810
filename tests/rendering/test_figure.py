"""Rows of shapes: the size of the sheet, ink in every cell, one scale."""

import numpy as np
import pytest
import trimesh

from tetgan.rendering.figure import NOTHING, Row, Shape, draw_rows
from tetgan.rendering.view import View

SIZE = (60, 60)


def box(width: float, height: float = 0.8) -> Shape:
    half = np.array([width, height, width]) / 2
    mesh = trimesh.creation.box(bounds=[0.5 - half, 0.5 + half])
    return Shape(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))


def cell(image: np.ndarray, row: int, column: int, left: int) -> np.ndarray:
    width, height = SIZE
    return image[row * height :, left + column * width :][:height, :width]


def test_every_shape_has_a_cell_and_short_rows_end_white():
    rows = [Row("one", [box(0.2), box(0.3), box(0.4)]), Row("two", [box(0.5)])]
    image = draw_rows(rows, View(size=SIZE))
    left = image.shape[1] - 3 * SIZE[0]
    assert left > 0 and image.shape[0] == 2 * SIZE[1]
    for place in ((0, 0), (0, 1), (0, 2), (1, 0)):
        assert 0.03 < (cell(image, *place, left) < 250).any(axis=2).mean() < 0.9
    for place in ((1, 1), (1, 2)):
        assert (cell(image, *place, left) == 255).all()


def test_a_missing_shape_is_said_and_nothing_is_left_white():
    image = draw_rows([Row("", [None, NOTHING, box(0.5)])], View(size=SIZE))
    missing, nothing, _ = (image[:, image.shape[1] - i * 60 :][:, :60] for i in (3, 2, 1))
    assert 0 < (missing < 250).any(axis=2).mean() < 0.1
    assert (nothing == 255).all()


def test_all_rows_have_one_scale():
    # A box twice as wide is twice as wide in the picture, also in a row seen from elsewhere.
    rows = [Row("", [box(0.2)]), Row("", [box(0.4)], azimuth=90)]
    image = draw_rows(rows, View(size=SIZE, azimuth=0, elevation=0))[:, -SIZE[0] :]
    narrow, wide = ((image[y : y + 60] < 250).any(axis=(0, 2)).sum() for y in (0, 60))
    assert wide == pytest.approx(2 * narrow, abs=2)


def test_captions_and_column_titles_take_room():
    bare = draw_rows([Row("", [box(0.3)])], View(size=SIZE))
    row = Row("", [box(0.3)], ["below\nit"], ruled=True)
    told = draw_rows([row], View(size=SIZE), ["above"], [(200, 0, 0)])
    assert told.shape[0] > bare.shape[0] + 30
    top = told[:15].astype(int)
    assert (top[..., 0] - top[..., 1]).max() > 60


def test_no_rows_are_refused():
    with pytest.raises(ValueError, match="at least one"):
        draw_rows([], View(size=SIZE))
