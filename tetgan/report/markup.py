"""Text and tables of files as escaped HTML."""

import base64
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import repeat
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from jinja2 import ChainableUndefined, TemplateError
from jinja2.sandbox import SandboxedEnvironment
from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token
from markupsafe import Markup, escape

from tetgan.errors import UserError

_NUMBER = re.compile(r"(—|[-+]?\d[\d,.]*(e[-+]?\d+)?\s*($|[±\[(%]))")

_ASIDE = re.compile(r"(?P<paper>\(paper [^()]*\))|(?P<interval>\[[-+\d.,e ]+\])")

_PAPERS = re.compile(r"paper\b(?!')|.*[_ ]paper$", re.IGNORECASE)  # title of a column of the paper's figures

_DEEPER = 2  # headings of a file are this many levels below those of the page


def cell_text(text: str) -> Markup:
    """Escaped text, with what follows a value set apart: its interval and the paper's figure."""
    parts, end = [], 0
    for match in _ASIDE.finditer(text):
        parts.append(escape(text[end : match.start()]))
        parts.append(Markup('<span class="{}">{}</span>').format(match.lastgroup, match.group()))
        end = match.end()
    return Markup("").join([*parts, escape(text[end:])])


def table_html(header: Sequence[str], rows: Sequence[Sequence[str]], *, numbers: bool = True) -> Markup:
    """A table in a box that scrolls sideways; numbers are on the right, columns of the paper in grey.

    Cells that are `Markup` already stay as they are, all others are escaped.

    Args:
        numbers: whether figures are numbers to compare; False for versions and the like.
    """
    cells = [[text if isinstance(text, Markup) else cell_text(text) for text in row] for row in rows]
    paper = [_PAPERS.match(title) is not None for title in header]
    right = [[numbers and _is_number(cell) for cell in row] for row in cells]
    above = [any(column) for column in zip(*right, strict=True)] or [False] * len(header)
    head = _line("th", [escape(title) for title in header], above, paper)
    body = Markup("").join(_line("td", row, number, paper) for row, number in zip(cells, right, strict=True))
    return Markup(
        '<div class="wide"><table>\n<thead>\n{}</thead>\n<tbody>\n{}</tbody>\n</table></div>\n'
    ).format(head, body)


def _line(tag: str, cells: Sequence[Markup], right: Sequence[bool], paper: Sequence[bool]) -> Markup:
    return Markup("<tr>{}</tr>\n").format(Markup("").join(map(_cell, repeat(tag), cells, right, paper)))


def _is_number(cell: Markup) -> bool:
    """Whether a cell begins with a figure, or is the dash of a missing one."""
    return _NUMBER.match(cell.striptags()) is not None


def _cell(tag: str, content: Markup, number: bool, paper: bool) -> Markup:
    kinds = " ".join(name for name, holds in (("number", number), ("paper", paper)) if holds)
    kind = Markup(' class="{}"').format(kinds) if kinds else Markup("")
    return Markup("<{0}{1}>{2}</{0}>").format(tag, kind, content)


def markdown_html(text: str) -> Markup:
    """Markdown as HTML, without first-level titles.

    Tags are shown as text; links and pictures are not made, so the page points nowhere.
    """
    parser = MarkdownIt("commonmark", {"html": False}, renderer_cls=_Renderer).enable("table")
    parser.disable(["link", "image", "autolink", "reference", "html_block", "html_inline"])
    tokens = list(_with_tables(_without_titles(parser.parse(text)), parser))
    return Markup(parser.renderer.render(tokens, parser.options, {}))


def _without_titles(tokens: Sequence[Token]) -> Iterator[Token]:
    inside = False
    for token in tokens:
        if token.tag == "h1":
            inside = token.type == "heading_open"
        elif not inside:
            yield token


def _with_tables(tokens: Iterator[Token], parser: MarkdownIt) -> Iterator[Token]:
    """The tokens, with all those of a table replaced by one that holds its HTML."""
    rows: list[list[Markup]] | None = None
    for token in tokens:
        if token.type == "table_open":
            rows = []
        elif rows is None:
            yield token
        elif token.type == "table_close":
            yield Token("html_block", "", 0, content=table_html(rows[0], rows[1:]))
            rows = None
        elif token.type == "tr_open":
            rows.append([])
        elif token.type == "inline":
            inline = parser.renderer.render([token], parser.options, {})
            rows[-1].append(Markup(inline))


class _Renderer(RendererHTML):
    """Text as in cells, headings below those of the page."""

    def text(self, tokens: Sequence[Token], place: int, options: Any, env: Any) -> str:
        return str(cell_text(tokens[place].content))

    def heading_open(self, tokens: Sequence[Token], place: int, options: Any, env: Any) -> str:
        return f"<h{_level(tokens[place])}>"

    def heading_close(self, tokens: Sequence[Token], place: int, options: Any, env: Any) -> str:
        return f"</h{_level(tokens[place])}>\n"


def _level(token: Token) -> int:
    return min(int(token.tag[1]) + _DEEPER, 6)


_ENVIRONMENT = SandboxedEnvironment(undefined=ChainableUndefined, autoescape=False)


def read_caption(
    folder: Path | None, names: Sequence[str], wildcards: Mapping[str, str], config: Mapping[str, Any]
) -> Markup:
    """Caption from the first of `{folder}/{name}.rst` that exists; empty where none does.

    The files are templates that may use `snakemake.wildcards` and `snakemake.config`; what these lack stays
    empty. Of reStructuredText
    only what Markdown shares is understood: paragraphs, lists, emphasis and ``literals``.

    Raises:
        UserError: a caption is not a valid template.
    """
    found = [path for name in names if folder and (path := folder / f"{name}.rst").is_file()]
    if not found:
        return Markup("")
    job = SimpleNamespace(wildcards=SimpleNamespace(**wildcards), config=config)
    try:
        text = _ENVIRONMENT.from_string(found[0].read_text()).render(snakemake=job)
    except TemplateError as error:
        raise UserError(f"{found[0]}: not a valid caption: {error}") from None
    return markdown_html(text)


def data_uri(content: bytes, kind: str) -> str:
    """`content` as an address that holds it; `kind` is its media type."""
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"
