"""Prose of the package: every module opens with a sentence that says what it does."""

import ast
from pathlib import Path

import pytest

MODULES = sorted((Path(__file__).parents[1] / "tetgan").rglob("*.py"))


def opening(module: Path) -> str:
    """First line of the module's docstring; empty without one."""
    return (ast.get_docstring(ast.parse(module.read_text())) or "").partition("\n")[0]


@pytest.mark.parametrize("module", MODULES, ids=lambda path: "/".join(path.parts[-3:]))
def test_a_module_says_what_it_does(module):
    first, *others = opening(module).split() or [""]
    assert others, "no docstring"
    assert first not in {"What", "Which", "How", "Who"}
