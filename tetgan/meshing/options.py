"""Options of meshing: mode, filter, smoothing, bounds on angles."""

from typing import Literal

from pydantic import Field

from tetgan.grids.options import Interior
from tetgan.options import Options

Mode = Literal["solid", "paper"]


class MeshingOptions(Options):
    """The paper's mesh by its two numbers, or one that is valid by construction."""

    gamma: float | None = Field(
        4.0, gt=0, description="surface tets displaced further than gamma*mu are dropped (Eq. 5); empty: none"
    )
    beta: float = Field(
        0.5, ge=0, le=1, description="share of its own position a smoothed vertex keeps (Eq. 4)"
    )
    mode: Mode = Field(
        "solid",
        description="'solid' makes every mesh valid; 'paper' leaves it as the paper's recipe makes it",
    )
    min_dihedral: float = Field(
        15.0,
        ge=0,
        le=25,
        description="least dihedral angle of a solid's tets, in degrees; the cut lattice has 25.3",
    )
    min_component: float = Field(
        0.002, ge=0, le=1, description="floating pieces of a solid below this share of its volume are dropped"
    )
    rounds: int = Field(
        4, ge=1, description="times that a solid's vertices move to where its tets are better"
    )
    resolution: float = Field(
        2.0,
        ge=0.5,
        le=4,
        description="cells along a solid's lattice, over those of one with as many tets as the grid",
    )
    interior: Interior = Field(
        "fine", description="tets inside a solid: all of one size, or coarser the further from its surface"
    )
