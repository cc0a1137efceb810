"""The model of docs/extending.md, as the document shows it."""

import re
from pathlib import Path
from typing import Any

import yaml

TEXT = (Path(__file__).parents[2] / "docs" / "extending.md").read_text()


def block(language: str) -> str:
    """The one block of code in a language."""
    (found,) = re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)
    return found


MODULE = block("python")
CONFIG: dict[str, Any] = yaml.safe_load(block("yaml"))


def write_module(folder: Path, text: str = MODULE) -> Path:
    """The package `my_models` with the module, in a folder that is to be on the path."""
    package = folder / "my_models"
    package.mkdir(exist_ok=True)
    (package / "__init__.py").touch()
    (package / "linear.py").write_text(text)
    return package / "linear.py"
