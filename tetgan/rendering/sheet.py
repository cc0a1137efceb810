"""Pictures side by side, with titles, and files of them."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw, ImageFont

from tetgan.files import whole_file

_INK = (40, 44, 52)


def contact_sheet(
    images: Sequence[UInt8[np.ndarray, "_h _w 3"]],
    columns: int,
    titles: Sequence[str] | None = None,
    row_titles: Sequence[str] | None = None,
) -> UInt8[np.ndarray, "H W 3"]:
    """Pictures of one size in rows of `columns`, on white.

    Args:
        titles: a line under each picture.
        row_titles: a line beside each row, on the left; it may hold line breaks.

    Raises:
        ValueError: no pictures, pictures of different sizes, or too few titles.
    """
    _check(images, columns, titles, row_titles)
    height, width = images[0].shape[:2]
    letters = max(10, height // 18)
    font = ImageFont.load_default(size=letters)
    line = round(letters * 1.5) if titles else 0
    left = _text_width(row_titles, font) if row_titles else 0
    rows = math.ceil(len(images) / columns)
    page = Image.new("RGB", (left + columns * width, rows * (height + line)), "white")
    draw = ImageDraw.Draw(page)
    for number, image in enumerate(images):
        x, y = left + number % columns * width, number // columns * (height + line)
        page.paste(Image.fromarray(image), (x, y))
        if titles:
            draw.text((x + width / 2, y + height + line / 2), titles[number], _INK, font, anchor="mm")
    for row, title in enumerate(row_titles or ()):
        draw.multiline_text((letters / 2, (row + 0.5) * (height + line)), title, _INK, font, anchor="lm")
    return np.asarray(page).copy()


def save_image(path: str | Path, image: UInt8[np.ndarray, "H W 3"]) -> None:
    """Write a picture, whole or not at all; the suffix names the format."""
    with whole_file(path) as partial:
        Image.fromarray(image).save(partial)


def _check(
    images: Sequence[np.ndarray], columns: int, titles: Sequence[str] | None, row_titles: Sequence[str] | None
) -> None:
    if not images or columns < 1:
        raise ValueError("a contact sheet needs at least one picture and one column")
    if len({image.shape for image in images}) > 1:
        raise ValueError("the pictures of a contact sheet differ in size")
    if titles is not None and len(titles) != len(images):
        raise ValueError(f"{len(titles)} titles for {len(images)} pictures")
    if row_titles is not None and len(row_titles) != math.ceil(len(images) / columns):
        raise ValueError(f"{len(row_titles)} row titles for {math.ceil(len(images) / columns)} rows")


def _text_width(texts: Sequence[str], font: ImageFont.FreeTypeFont | ImageFont.ImageFont) -> int:
    lines = [line for text in texts for line in text.splitlines()]
    return math.ceil(max(font.getlength(line) for line in lines)) + 12
