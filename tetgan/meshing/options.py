"""Options of meshing: mode, filter, smoothing, bounds on angles."""

from typing import Literal

from pydantic import Field

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
        le=30,
        description="least dihedral angle of a solid's tets, in degrees; the lattice has 30",
    )
    min_component: float = Field(
        0.002, ge=0, le=1, description="floating pieces of a solid below this share of its volume are dropped"
    )
    rounds: int = Field(
        6, ge=1, description="times that a solid's boundary is moved towards where the field wants it"
    )
