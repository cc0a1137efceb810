"""Options of points and voxels, the entries under `samplings` of the config."""

from typing import Annotated, Literal

from pydantic import Field

from tetgan.options import Options


class PointOptions(Options):
    """Occupancy at random points, which OccNet learns from."""

    kind: Literal["points"]
    count: int = Field(100_000, ge=1, description="points a shape; the paper's are 100,000")
    box: float = Field(1.1, ge=1, le=2, description="side of the cube of points, in sides of the unit cube")
    seed: int = Field(0, ge=0, description="seed of the points")


class VoxelOptions(Options):
    """Signed distance at the cells of the unit cube, which ShapeGAN learns from."""

    kind: Literal["voxels"]
    resolution: Literal[8, 16, 32, 64] = Field(
        64, description="cells along a side; ShapeGAN's are 64 (GAN) and 32 (VAE)"
    )


Sampling = PointOptions | VoxelOptions

ShapeSampling = Annotated[Sampling, Field(discriminator="kind")]
