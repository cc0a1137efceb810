"""Contact sheets and their files."""

import numpy as np
import pytest
from PIL import Image

from tetgan.rendering.sheet import contact_sheet, note, save_image

GREY = np.full((40, 60, 3), 128, dtype=np.uint8)


def test_pictures_stand_in_rows():
    sheet = contact_sheet([GREY] * 5, columns=2)
    assert sheet.shape == (3 * 40, 2 * 60, 3)
    assert (sheet[:80] == 128).all() and (sheet[80:, :60] == 128).all()
    assert (sheet[80:, 60:] == 255).all()


def test_titles_take_room_and_leave_ink():
    sheet = contact_sheet([GREY] * 2, columns=2, titles=["one", "two"], row_titles=["a row\nof two"])
    below = sheet[40:]
    assert sheet.shape[0] > 40 and sheet.shape[1] > 120
    assert below.min() < 100 and sheet[:40, :-120].min() < 100


def test_a_rule_runs_across_the_page_above_its_row():
    plain, ruled = (contact_sheet([GREY] * 2, 1, row_titles=["a", "b"], ruled_rows=r) for r in ((), (1,)))
    rows = np.flatnonzero((plain != ruled).any(axis=(1, 2)))
    assert rows.tolist() == [40]
    assert (ruled[40] != 255).all()


def test_a_note_is_faint_and_in_the_middle():
    rows, columns = np.nonzero((note(np.full_like(GREY, 255), "empty") < 255).any(axis=2))
    assert abs(rows.mean() - 20) < 4 and abs(columns.mean() - 30) < 4


def test_saving_is_whole_and_lossless(tmp_path):
    save_image(tmp_path / "figures" / "sheet.png", GREY)
    assert np.array_equal(np.asarray(Image.open(tmp_path / "figures" / "sheet.png")), GREY)
    assert [path.name for path in (tmp_path / "figures").iterdir()] == ["sheet.png"]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"images": [], "columns": 2}, "at least one"),
        ({"images": [GREY], "columns": 0}, "at least one"),
        ({"images": [GREY, GREY[:20]], "columns": 2}, "differ in size"),
        ({"images": [GREY], "columns": 1, "titles": ["a", "b"]}, "2 titles for 1"),
        ({"images": [GREY] * 3, "columns": 2, "row_titles": ["a"]}, "1 row titles for 2 rows"),
        ({"images": [GREY] * 3, "columns": 2, "column_titles": ["a"]}, "1 column titles for 2 columns"),
    ],
)
def test_bad_arguments_are_named(arguments, complaint):
    with pytest.raises(ValueError, match=complaint):
        contact_sheet(**arguments)
