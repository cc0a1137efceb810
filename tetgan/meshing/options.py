"""How a field becomes a solid mesh."""

from typing import Literal

from pydantic import Field

from tetgan.options import Options


class MeshingOptions(Options):
    """The paper's two numbers, and which vertices move."""

    gamma: float | None = Field(
        4.0, gt=0, description="surface tets displaced further than gamma*mu are dropped (Eq. 5); empty: none"
    )
    beta: float = Field(
        0.5, ge=0, le=1, description="share of its own position a smoothed vertex keeps (Eq. 4)"
    )
    mode: Literal["paper"] = Field("paper", description="'paper' displaces the boundary vertices only")
