"""Options of a grid: a lattice or a `.tet` file, and the number of subdivisions."""

from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from tetgan.options import Options

Interior = Literal["graded", "fine"]
"""Tets inside a surface: coarser the further from it, or all of the finest level."""


class GridOptions(Options):
    """Exactly one of `cells` and `file`; the finest grid has 8^depth times as many tets as the base."""

    cells: int | None = Field(None, ge=1, le=32, description="lattice cells along each side of the cube")
    depth: int = Field(ge=0, le=6, description="number of 1-to-8 subdivisions")
    file: Path | None = Field(None, description="base grid as a QuarTet `.tet` file, in place of `cells`")

    @model_validator(mode="after")
    def _one_base(self) -> "GridOptions":
        if (self.cells is None) == (self.file is None):
            raise ValueError("give exactly one of 'cells' and 'file'")
        return self
