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


def ink(cell: np.ndarray) -> float:
    return float((cell < 250).any(axis=2).mean())


def test_every_shape_has_a_cell_and_short_rows_end_white(cells):
    rows = [Row("one", [box(0.2), box(0.3), box(0.4)]), Row("two", [box(0.5)])]
    image = draw_rows(rows, View(size=SIZE))
    width = cells[0].shape[1]
    assert len(cells) == 6 and image.shape[0] == 2 * SIZE[1] and image.shape[1] > 3 * width
    assert all(0.03 < ink(cell) < 0.9 for cell in cells[:4]) and ink(cells[4]) == ink(cells[5]) == 0


def test_a_missing_shape_is_said_and_nothing_is_left_white(cells):
    draw_rows([Row("", [None, NOTHING, box(0.5)])], View(size=(90, 60)))
    assert 0 < ink(cells[0]) < 0.1 and ink(cells[1]) == 0 and ink(cells[2]) > 0.2


def test_cells_are_no_wider_than_the_shapes_and_no_wider_than_asked(cells):
    # Seen from the front at eye level: a box 0.4 wide and 0.5 tall is 0.8 as wide as tall.
    straight = View(size=SIZE, azimuth=0, elevation=0)
    for shape, width in ((box(0.4, 0.5), 48), (box(0.1, 0.9), 36), (box(0.9, 0.1), 60)):
        draw_rows([Row("", [shape])], straight)
        assert cells[0].shape[:2] == (60, width)


def test_all_rows_have_one_scale(cells):
    # A box twice as wide is twice as wide in the picture, also in a row seen from elsewhere.
    rows = [Row("", [box(0.2)]), Row("", [box(0.4)], azimuth=90)]
    draw_rows(rows, View(size=SIZE, azimuth=0, elevation=0))
    narrow, wide = ((cell < 250).any(axis=(0, 2)).sum() for cell in cells)
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
