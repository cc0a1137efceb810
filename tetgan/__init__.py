"""Learned tetrahedral mesh generation: TetGAN (Gao et al., BMVC 2022) as a library and a workflow."""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tetgan.meshing.solidify import solidify as solidify

__version__ = version("tetgan")

_LAZY = {"solidify": "tetgan.meshing.solidify"}
"""What is imported when it is first asked for, and the module that it is in."""


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'tetgan' has no attribute '{name}'")
    return getattr(import_module(_LAZY[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_LAZY])
