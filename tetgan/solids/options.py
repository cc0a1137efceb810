"""Options of files for solvers."""

from typing import Literal

from pydantic import Field

from tetgan.options import Options
from tetgan.solids.regions import REACH


class ExportOptions(Options):
    """Elements, units, and how far the named sides of a mesh reach."""

    order: Literal[1, 2] = Field(1, description="degree of the elements")
    units: Literal["m", "cm", "mm", "in"] = Field("m", description="unit of the written coordinates")
    scale: float = Field(1.0, gt=0, description="metres per unit of the mesh")
    reach: float = Field(REACH, ge=0, le=1, description="depth of a side, over the mesh's longest extent")
