"""Tables under results as HTML, with the whole CSV to save."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
from markupsafe import Markup

from tetgan.errors import UserError
from tetgan.report.markup import data_uri, markdown_html, read_caption, table_html

MOST_COLUMNS = 12
"""A CSV without a Markdown twin shows this many columns."""

_SUPPLEMENT = ("fid", "variety", "reconstruction")  # the supplement's tables share a caption

_LAST = ("dataset", "runtime")  # about the run, not about the models


@dataclass(frozen=True)
class Table:
    """A table of the page: `html` is shown, `csv` is a data URI of the file."""

    name: str
    path: str
    caption: Markup
    html: Markup
    csv: str


def read_tables(
    results: Path, categories: Sequence[str], captions: Path | None, config: Mapping[str, Any]
) -> list[Table]:
    """Every `tables/*.csv`: the categories first, then the rest by name.

    A table's caption is named like the table; categories share `table`, the supplement's tables `supplement`.

    Raises:
        UserError: a table or a caption cannot be read.
    """
    paths = sorted(results.glob("tables/*.csv"), key=lambda path: _place(path.stem, categories))
    return [
        Table(
            name=path.stem,
            path=path.relative_to(results).as_posix(),
            caption=read_caption(
                captions, _caption_names(path.stem, categories), _wildcards(path.stem, categories), config
            ),
            html=_shown(path),
            csv=data_uri(path.read_bytes(), "text/csv"),
        )
        for path in paths
        if not path.name.startswith(".")
    ]


def _place(name: str, categories: Sequence[str]) -> tuple[int, int, str]:
    if name in categories:
        return 0, categories.index(name), name
    return 1 + (name in _LAST), 0, name


def _caption_names(name: str, categories: Sequence[str]) -> list[str]:
    if name in categories:
        return [name, "table"]
    return [name, "supplement"] if name in _SUPPLEMENT else [name]


def _wildcards(name: str, categories: Sequence[str]) -> dict[str, str]:
    """Those of the job that made the table."""
    if name in categories:
        return {"category": name}
    return {"figure": name} if name in _SUPPLEMENT else {}


def _shown(path: Path) -> Markup:
    twin = path.with_suffix(".md")
    if twin.is_file():
        return markdown_html(twin.read_text())
    try:
        table = pd.read_csv(path, dtype=str, keep_default_na=False)
    except (ValueError, pd.errors.ParserError) as error:
        raise UserError(f"{path}: not a CSV table: {error}") from None
    left_out = len(table.columns) - MOST_COLUMNS
    shown = table.iloc[:, :MOST_COLUMNS].map(_rounded)
    note = Markup("<p>{} more columns are in the CSV.</p>\n").format(left_out) if left_out > 0 else ""
    return table_html(list(shown.columns), shown.to_numpy().tolist()) + note


def _rounded(text: str) -> str:
    """Four digits that count, for numbers that have more."""
    try:
        value = float(text)
    except ValueError:
        return text
    return f"{value:.4g}" if "." in text and abs(value) < 1000 else text
