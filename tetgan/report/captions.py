"""Captions of tables and figures: the same files that Snakemake's own report uses."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from jinja2 import ChainableUndefined, TemplateError
from jinja2.sandbox import SandboxedEnvironment
from markupsafe import Markup

from tetgan.errors import UserError
from tetgan.report.markup import markdown_html

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
