"""Pictures side by side, with titles, and files of them."""

import math
from collections.abc import Collection, Sequence
from itertools import accumulate
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw, ImageFont

from tetgan.files import whole_file

Ink = tuple[int, int, int]

INK: Ink = (40, 44, 52)

FAINT: Ink = (165, 170, 178)

_RULE: Ink = (205, 208, 214)

_LETTERS = 80  # across a page at least: about seven points where it is printed across a sheet

_LINE = 1.4  # height of a line of text, over that of its letters

_Font = ImageFont.FreeTypeFont | ImageFont.ImageFont


def contact_sheet(
    images: Sequence[UInt8[np.ndarray, "_h _w 3"]],
    columns: int,
    *,
    titles: Sequence[str] | None = None,
    row_titles: Sequence[str] | None = None,
    column_titles: Sequence[str] | None = None,
    column_inks: Sequence[Ink] | None = None,
    ruled_rows: Collection[int] = (),
) -> UInt8[np.ndarray, "H W 3"]:
    """Pictures of one size in rows of `columns`, on white. Any text may hold line breaks.

    Args:
        titles: text under each picture.
        row_titles: text beside each row, on the left.
        column_titles: text above each column, in the colours `column_inks` if there are any.
        ruled_rows: rows with a thin line above them.

    Raises:
        ValueError: no pictures, pictures of different sizes, or too few titles.
    """
    _check(images, columns, titles, row_titles, column_titles)
    height, width = images[0].shape[:2]
    letters = max(letters_of(height), columns * width // _LETTERS)
    font = ImageFont.load_default(size=letters)
    above = _text_height(column_titles or (), letters)
    left = _text_width(row_titles, font) + letters if row_titles else 0
    tops, belows = _row_places(titles or len(images) * [""], columns, height, letters)
    page = Image.new("RGB", (left + columns * width, above + tops[-1]), "white")
    draw = ImageDraw.Draw(page)
    for column, title in enumerate(column_titles or ()):
        ink = column_inks[column] if column_inks else INK
        _write(draw, (left + (column + 0.5) * width, above / 2), title, font, ink=ink)
    for number, image in enumerate(images):
        row, column = divmod(number, columns)
        x, y = left + column * width, above + tops[row]
        page.paste(Image.fromarray(image), (x, y))
        if titles:
            _write(draw, (x + width / 2, y + height + belows[row] / 2), titles[number], font)
    for row, title in enumerate(row_titles or ()):
        _write(draw, (letters / 2, above + tops[row] + height / 2), title, font, anchor="lm")
    for row in ruled_rows:
        draw.line((0, above + tops[row], page.width, above + tops[row]), _RULE, max(1, letters // 12))
    return np.asarray(page).copy()


def note(image: UInt8[np.ndarray, "H W 3"], text: str) -> UInt8[np.ndarray, "H W 3"]:
    """The picture with a faint text in its middle."""
    page = Image.fromarray(image)
    font = ImageFont.load_default(size=letters_of(page.height))
    _write(ImageDraw.Draw(page), (page.width / 2, page.height / 2), text, font, ink=FAINT)
    return np.asarray(page).copy()


def letters_of(height: int) -> int:
    """Size in pixels of the letters that go with pictures of a height."""
    return max(10, height // 13)


def save_image(path: str | Path, image: UInt8[np.ndarray, "H W 3"]) -> None:
    """Write a picture, whole or not at all; the suffix names the format."""
    with whole_file(path) as partial:
        Image.fromarray(image).save(partial)


def _check(
    images: Sequence[np.ndarray],
    columns: int,
    titles: Sequence[str] | None,
    row_titles: Sequence[str] | None,
    column_titles: Sequence[str] | None,
) -> None:
    if not images or columns < 1:
        raise ValueError("a contact sheet needs at least one picture and one column")
    if len({image.shape for image in images}) > 1:
        raise ValueError("the pictures of a contact sheet differ in size")
    if titles is not None and len(titles) != len(images):
        raise ValueError(f"{len(titles)} titles for {len(images)} pictures")
    if row_titles is not None and len(row_titles) != math.ceil(len(images) / columns):
        raise ValueError(f"{len(row_titles)} row titles for {math.ceil(len(images) / columns)} rows")
    if column_titles is not None and len(column_titles) != columns:
        raise ValueError(f"{len(column_titles)} column titles for {columns} columns")


def _write(
    draw: ImageDraw.ImageDraw,
    place: tuple[float, float],
    text: str,
    font: _Font,
    *,
    ink: Ink = INK,
    anchor: str = "mm",
) -> None:
    """Lines of text about a place; `anchor` as Pillow has it, for every line."""
    lines = text.split("\n")
    pitch = _LINE * getattr(font, "size", 10)
    for number, line in enumerate(lines):
        down = (number - (len(lines) - 1) / 2) * pitch
        draw.text((place[0], place[1] + down), line, ink, font, anchor=anchor)


def _text_width(texts: Sequence[str], font: _Font) -> int:
    lines = [line for text in texts for line in text.splitlines()]
    return math.ceil(max((font.getlength(line) for line in lines), default=0))


def _text_height(texts: Sequence[str], letters: int) -> int:
    """Room for the tallest text, and half a line; none for no text."""
    lines = max((text.count("\n") + 1 for text in texts if text), default=0)
    return round((lines + 0.5) * _LINE * letters) if lines else 0


def _row_places(
    titles: Sequence[str], columns: int, height: int, letters: int
) -> tuple[list[int], list[int]]:
    """Where each row begins, and where the last ends; and the room that each has for its titles."""
    rows = range(0, len(titles), columns)
    belows = [_text_height(titles[start : start + columns], letters) for start in rows]
    return [0, *accumulate(height + below for below in belows)], belows
