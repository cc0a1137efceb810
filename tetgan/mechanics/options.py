"""Options of a simulation: material, supports and loads."""

from typing import Literal

from pydantic import Field

from tetgan.mechanics.materials import MATERIALS, Material
from tetgan.options import Options
from tetgan.solids.regions import REACH


class LoadCase(Options):
    """A body on its supports, under its loads."""

    material: Literal["pinewood", "steel", "rubber"] | Material = Field(
        "pinewood", description="a preset, or young, poisson and density"
    )
    fix: list[str] = Field(
        ["floor"],
        min_length=1,
        description="regions held still: floor, top, left, right, back, front, surface, two corners of a"
        " box x,y,z:x,y,z, a plane y=0, or a side of it y<0.1, in the units of the mesh; '/y' behind one"
        " holds that component alone",
    )
    load: list[str] = Field(
        ["top=500N"],
        description="region=force: the total, spread evenly over the region's faces; downward, or 'x,y,z' N",
    )
    gravity: bool = Field(False, description="also the body's own weight")
    size: float = Field(1.0, gt=0, description="metres per unit of the mesh")
    order: Literal[1, 2] = Field(2, description="degree of the elements; those of degree 1 lock in bending")
    refine: int = Field(0, ge=0, le=3, description="times that each tet is cut into eight first")
    reach: float = Field(
        REACH,
        ge=0,
        le=1,
        description="depth of a side such as the floor, from the outermost face that looks there, over the"
        " longest extent of the mesh",
    )

    @property
    def stuff(self) -> Material:
        """The material itself."""
        return MATERIALS[self.material] if isinstance(self.material, str) else self.material


class RemeshOptions(Options):
    """fTetWild (Hu et al. 2020), which meshes the inside of any surface anew."""

    edge: float = Field(
        0.05, gt=0, lt=1, description="length of edges to aim at, over the diagonal of the box around a shape"
    )
    envelope: float = Field(
        0.001,
        gt=0,
        lt=0.1,
        description="how far the new surface may lie from the old one, over that diagonal",
    )
    timeout_seconds: float = Field(120.0, gt=0, description="processor time after which a shape is given up")


class SimulationOptions(Options):
    """Samples under load, and some of them remeshed for comparison."""

    models: list[str] = Field([], description="models whose samples are simulated")
    samples: int = Field(200, ge=1, description="most samples of each model and mode, the first ones")
    remeshed: int = Field(
        20, ge=0, description="most of them whose surface is remeshed by fTetWild too (needs pytetwild)"
    )
    case: LoadCase = Field(LoadCase(), description="material, supports and loads")
    remeshing: RemeshOptions = Field(RemeshOptions(), description="fTetWild")
