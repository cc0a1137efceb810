"""The models of docs/extending.md, as the document shows them."""

import re
from pathlib import Path
from typing import Any

import yaml

TEXT = (Path(__file__).parents[2] / "docs" / "extending.md").read_text()


def blocks(language: str) -> list[str]:
    """The blocks of code in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


MODULE, ON_CODES = blocks("python")
CONFIG: dict[str, Any]
CONFIG, CONFIG_ON_CODES = map(yaml.safe_load, blocks("yaml"))


def write_module(folder: Path, text: str = MODULE, name: str = "linear") -> Path:
    """The package `my_models` with the module, in a folder that is to be on the path."""
    package = folder / "my_models"
    package.mkdir(exist_ok=True)
    (package / "__init__.py").touch()
    (package / f"{name}.py").write_text(text)
    return package / f"{name}.py"
