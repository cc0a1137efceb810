"""Prose: modules open with a sentence that says what they do, and pages name files that exist."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MODULES = sorted((ROOT / "tetgan").rglob("*.py"))
PAGES = sorted([*(ROOT / "docs").rglob("*.md"), ROOT / "README.md", ROOT / "config" / "README.md"])
LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")
SOURCE = re.compile(r"`((?:tetgan|meshing|benchmarks|workflow|tests|config)/[\w/.-]*)`")


def opening(module: Path) -> str:
    """First line of the module's docstring; empty without one."""
    return (ast.get_docstring(ast.parse(module.read_text())) or "").partition("\n")[0]


@pytest.mark.parametrize("module", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_module_says_what_it_does(module):
    first, *others = opening(module).split() or [""]
    assert others, "no docstring"
    assert first not in {"What", "Which", "How", "Who"}


# Notes name the files of their day.
@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_page_links_to_pages_and_names_files_that_exist(page):
    text = page.read_text()
    missing = [name for name in LINK.findall(text) if not (page.parent / name).exists()]
    if page.parent.name != "notes":
        named = SOURCE.findall(text)
        missing += [name for name in named if not any((ROOT / top / name).exists() for top in ("", "tetgan"))]
    assert missing == []
