"""Pictures under results, reduced to fit into the page."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup
from PIL import Image, UnidentifiedImageError

from tetgan.errors import UserError
from tetgan.report.markup import data_uri, read_caption

BUDGET = 6_000_000
"""Bytes of all pictures together, before base64 adds a third."""

_MOST_DATA = 100_000  # bytes of a figure's data that the page takes along

_WIDTHS = (1600, 1200, 900, 600)  # tried in turn, after its own, until a picture fits its share

_QUALITY = 80  # of WebP, a fifth of the bytes of a rendered PNG

_LONGEST = 16383  # pixels on a side of a WebP


@dataclass(frozen=True)
class Figure:
    """A figure of the page.

    Attributes:
        category: empty for a figure that belongs to none.
        data: data URI of the CSV beside it; empty where there is none, or a large one.
    """

    name: str
    category: str
    path: str
    caption: Markup
    picture: str
    data: str
    width: int
    height: int
    reduced: bool


def read_figures(
    results: Path,
    categories: Sequence[str],
    captions: Path | None,
    config: Mapping[str, Any],
    budget: int = BUDGET,
) -> list[Figure]:
    """Every PNG under `figures/`: those of the categories in their order, then the rest by path.

    Pictures are in the page byte for byte as long as all of them fit the budget; the largest are reduced
    otherwise, and say so.

    Raises:
        UserError: a file is no picture, or a caption cannot be read.
    """
    folder = results / "figures"
    paths = [path for path in folder.rglob("*.png") if not path.name.startswith(".")]
    paths.sort(key=lambda path: _place(path.relative_to(folder), categories))
    originals = {path: path.read_bytes() for path in paths}
    fitted = fit_pictures(originals, budget)
    return [
        _figure(path, folder, originals[path], fitted[path], _caption(path, folder, captions, config))
        for path in paths
    ]


def _place(path: Path, categories: Sequence[str]) -> tuple[int, str]:
    first = path.parts[0]
    return categories.index(first) if first in categories else len(categories), path.as_posix()


def _caption(path: Path, folder: Path, captions: Path | None, config: Mapping[str, Any]) -> Markup:
    category = _category(path, folder)
    return read_caption(captions, [path.stem], {"category": category} if category else {}, config)


def _category(path: Path, folder: Path) -> str:
    parts = path.relative_to(folder).parts
    return parts[0] if len(parts) > 1 else ""


def _figure(path: Path, folder: Path, original: bytes, shown: bytes, caption: Markup) -> Figure:
    width, height = _open(shown, path).size
    return Figure(
        name=path.stem,
        category=_category(path, folder),
        path=path.relative_to(folder.parent).as_posix(),
        caption=caption,
        picture=data_uri(shown, "image/png" if shown is original else "image/webp"),
        data=_data(path.with_suffix(".csv")),
        width=width,
        height=height,
        reduced=shown is not original,
    )


def _data(path: Path) -> str:
    fits = path.is_file() and path.stat().st_size <= _MOST_DATA
    return data_uri(path.read_bytes(), "text/csv") if fits else ""


def fit_pictures(pictures: Mapping[Path, bytes], budget: int) -> dict[Path, bytes]:
    """The pictures, the largest of them reduced so that all together come near the budget or stay below."""
    fitted, left = {}, budget
    for done, (path, content) in enumerate(sorted(pictures.items(), key=lambda item: len(item[1]))):
        share = left // (len(pictures) - done)
        fitted[path] = content if len(content) <= share else _reduced(content, path, share)
        left -= len(fitted[path])
    return fitted


def _reduced(content: bytes, path: Path, share: int) -> bytes:
    """The picture as WebP: the widest that fits the share, or else the narrowest."""
    picture = _open(content, path).convert("RGB")
    for width in (picture.width, *(width for width in _WIDTHS if width < picture.width)):
        smaller = _as_webp(picture, width / picture.width)
        if len(smaller) <= share:
            break
    return smaller


def _as_webp(picture: Image.Image, scale: float) -> bytes:
    scale = min(scale, _LONGEST / max(picture.size))
    into = io.BytesIO()
    width, height = (max(1, round(side * scale)) for side in picture.size)
    picture.resize((width, height)).save(into, "WEBP", quality=_QUALITY)
    return into.getvalue()


def _open(content: bytes, path: Path) -> Image.Image:
    try:
        return Image.open(io.BytesIO(content))
    except (UnidentifiedImageError, Image.DecompressionBombError) as error:
        raise UserError(f"{path}: no picture that can be shown: {error}") from None
