"""Learned tetrahedral mesh generation: TetGAN (Gao et al., BMVC 2022) as a library and a workflow."""

from importlib import import_module
from importlib.metadata import version
from typing import Any

__version__ = version("tetgan")

# Imported when first asked for, and put together from parts: on what the package names, every stage of the
# workflow would depend (`tetgan.code`).
_LAZY = {"solidify": ("meshing", "solidify")}
"""Name to the place of its module in this package."""


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'tetgan' has no attribute '{name}'")
    return getattr(import_module(".".join((__name__, *_LAZY[name]))), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_LAZY])
