"""How the latent space is explored, and how new samples are measured."""

from typing import Literal

from pydantic import Field

from tetgan.options import Options


class LatentOptions(Options):
    """Interpolations and sums of latents."""

    pairs: int = Field(3, ge=0, description="pairs of validation shapes that are interpolated")
    steps: int = Field(7, ge=2, description="shapes from one end of an interpolation to the other")
    path: Literal["linear", "spherical"] = Field(
        "linear",
        description="course through the latent space: straight, or a turn about the origin for normal priors",
    )
    triples: int = Field(3, ge=0, description="triples of validation shapes of which A - B + C is made")
    changed: float = Field(
        0.05,
        gt=0,
        lt=1,
        description="distance in cube sides beyond which a part of one shape is missing in another",
    )
    points: int = Field(10_000, ge=100, description="points sampled on each surface for distances")
    seed: int = Field(0, ge=0, description="seed of the pairs and of the sampled points")


class NearestOptions(Options):
    """The training shape nearest to each sample."""

    samples: int = Field(64, ge=1, description="most samples that are looked up, the first ones")
    points: int = Field(10_000, ge=100, description="points sampled on each surface")
    seed: int = Field(0, ge=0, description="seed of the sampled points")
