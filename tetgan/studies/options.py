"""Options of the studies."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from tetgan.mechanics.options import SimulationOptions
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


class TorusOptions(Options):
    """The torus of the resolution study; the paper does not say which it was."""

    major: float = Field(0.32, gt=0, lt=0.5, description="radius of the ring, in cube sides")
    minor: float = Field(0.16, gt=0, lt=0.5, description="radius of the tube, in cube sides")
    axis: tuple[float, float, float] = Field(
        (1.0, 2.0, 3.0), description="direction of its axis; by default along no symmetry of the lattice"
    )

    @model_validator(mode="after")
    def _fits(self) -> "TorusOptions":
        if self.minor >= self.major:
            raise ValueError(f"minor ({self.minor}) must be less than major ({self.major})")
        if self.major + self.minor >= 0.5:
            raise ValueError("major + minor must be below 0.5, so that the torus fits the cube")
        if not any(self.axis):
            raise ValueError("axis has no direction")
        return self


class ResolutionOptions(Options):
    """Errors of tetrahedra and voxels on an exact torus."""

    torus: TorusOptions = Field(TorusOptions(), description="the shape")
    depth: int = Field(3, ge=0, le=6, description="subdivisions of every lattice")
    cells: list[Annotated[int, Field(ge=1)]] = Field(
        [1, 2, 3, 4, 5, 6, 8, 10],
        min_length=1,
        description="lattices for undeformed tets; 10 cells at depth 3 are 6.8 million tets (189^3)",
    )
    deformed_cells: list[Annotated[int, Field(ge=1)]] = Field(
        [1, 2, 3, 4, 5, 6], min_length=1, description="lattices for deformed tets"
    )
    reference_cells: int = Field(
        2, ge=1, description="the deformed lattice whose error the others must reach; the paper's LR, 41^3"
    )
    voxels: list[Annotated[int, Field(ge=4)]] = Field(
        [16, 24, 32, 48, 64, 96, 128, 192, 256, 301],
        min_length=1,
        description="voxels along each side of the cube",
    )
    points: int = Field(
        100_000, ge=100, le=10_000_000, description="points on each surface that a mean distance averages"
    )
    seed: int = Field(0, ge=0, description="seed of those points")

    @model_validator(mode="after")
    def _reference_is_measured(self) -> "ResolutionOptions":
        if self.reference_cells not in self.deformed_cells:
            raise ValueError(f"reference_cells ({self.reference_cells}) is not among deformed_cells")
        return self


class SmoothingOptions(Options):
    """Displacement and smoothing, variant by variant."""

    models: list[str] = Field(
        [], description="models whose fields are smoothed; a `representation` gives ground-truth fields"
    )
    shapes: int = Field(64, ge=1, description="most validation shapes compared with their repaired meshes")
    crease: float = Field(
        30.0, gt=0, lt=180, description="degrees by which the surface bends at an edge that counts as sharp"
    )
    crease_points: int = Field(
        2000, ge=10, description="points on the sharp edges of a repaired mesh that distances start from"
    )


class StudyOptions(Options):
    """The studies beside the tables."""

    resolution: ResolutionOptions = Field(ResolutionOptions(), description="the paper's torus figure")
    smoothing: SmoothingOptions = Field(SmoothingOptions(), description="the paper's smoothing figure")
    simulation: SimulationOptions = Field(
        SimulationOptions(), description="the paper's figure of a table under load, on many samples"
    )
