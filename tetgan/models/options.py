"""Which model is built: one line of the config under `models`."""

from typing import Any, Literal

from pydantic import Field

from tetgan.options import Options


class KindOptions(Options):
    """What the options of every model have; each class allows one word for `kind`."""

    kind: str


class TetganOptions(KindOptions):
    """TetGAN: a variational autoencoder on a tetrahedral hierarchy and its two critics."""

    kind: Literal["tetgan"] = "tetgan"
    grid: str = Field(description="name of the grid, a key of `grids`")
    latent: Literal["global", "tet", "conv"] = Field(
        "global",
        description="one code a shape (global), or one a coarse tet by MLP (tet) or convolution (conv)",
    )
    code: int = Field(512, ge=1, description="length of a latent code; the paper's is 512")
    width: int = Field(64, ge=1, description="channels at the finest level, doubled at each coarser one")
    base_width: int | None = Field(
        None, ge=1, description="channels at the coarsest level; empty: as many as `code`, like the paper"
    )
    prior: Literal["normal", "fitted"] = Field(
        "normal",
        description="codes drawn: independent normals, or the normal distribution of the training codes",
    )
    convolution: Literal["tet", "shared"] = Field(
        "tet",
        description="a matrix for each of the four neighbors (tet), or one shared by them, as in a graph "
        "convolution (shared); the critics' too",
    )
    pool: Literal["max", "mean"] = Field("max", description="how eight children become their parent")
    upsample: Literal["inverse_distance", "copy"] = Field(
        "inverse_distance", description="children average their parent and its neighbors, or copy the parent"
    )
    displacement: bool = Field(
        True, description="learn the displacement field; no: occupancy alone, and vertices stay on the grid"
    )
    displacement_range: float = Field(
        1.0,
        gt=0,
        le=1,
        description="largest displacement the networks tell apart, a share of the largest there is",
    )
    local_critic_width: int = Field(16, ge=1, description="channels of the local critic's first convolution")
    global_critic_width: int = Field(64, ge=1, description="channels of the global critic's finest level")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )
    meshing: dict[str, Any] = Field(
        default_factory=dict, description="meshing options that differ for this model"
    )


class DeftetOptions(KindOptions):
    """DefTet's surface network: a graph convolution moves the boundary that another model decodes."""

    kind: Literal["deftet"]
    grid: str = Field(description="name of the grid, a key of `grids`")
    of: str = Field(description="name of the TetGAN model that gives the occupancy, on the same grid")
    width: int = Field(64, ge=1, description="channels of the graph convolutions")
    blocks: int = Field(3, ge=1, description="residual blocks of two graph convolutions each")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )


class PcaOptions(KindOptions):
    """Principal components of the training fields: the linear yardstick."""

    kind: Literal["pca"]
    grid: str = Field(description="name of the grid, a key of `grids`")
    components: int = Field(64, ge=1, description="number of principal components kept")


class RepresentationOptions(KindOptions):
    """Ground-truth fields in place of a model: the best that any model on the grid can do."""

    kind: Literal["representation"]
    grid: str = Field(description="name of the grid, a key of `grids`")


class OccNetOptions(KindOptions):
    """OccNet without an input to condition on: a variational autoencoder of occupancy at points."""

    kind: Literal["occnet"]
    sampling: str = Field("points", description="name of the sampling, a key of `samplings`, of kind points")
    code: int = Field(128, ge=1, description="length of the latent code; the paper's is 128")
    mise_start: int = Field(32, ge=2, description="cells along a side of the coarsest grid that is evaluated")
    mise_steps: int = Field(
        2, ge=0, le=5, description="how many times cells on the surface are halved: 32 and 2 make 128"
    )
    threshold: float = Field(0.2, gt=0, lt=1, description="occupancy probability at the surface")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )


class ShapeGanOptions(KindOptions):
    """ShapeGAN (GAN): a network of signed distance, judged by a critic of voxels that grows."""

    kind: Literal["shapegan-gan"]
    sampling: str = Field(
        "voxels-64", description="name of the sampling, a key of `samplings`, of kind voxels"
    )
    code: int = Field(128, ge=1, description="length of the latent code; the paper's is 128")
    resolution: int = Field(64, ge=8, le=256, description="cells along a side when a surface is extracted")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )


class ShapeGanVaeOptions(KindOptions):
    """ShapeGAN (VAE): a variational autoencoder of 32³ voxels of signed distance."""

    kind: Literal["shapegan-vae"]
    sampling: str = Field(
        "voxels-32", description="name of the sampling, a key of `samplings`, of 32³ voxels"
    )
    code: int = Field(128, ge=1, description="length of the latent code; the paper's is 128")
    training: dict[str, Any] = Field(
        default_factory=dict, description="training options that differ for this model"
    )


class SimplifiedOptions(KindOptions):
    """The samples of another model with fewer faces; nothing is trained. The paper's rows with a star."""

    kind: Literal["simplified"]
    of: str = Field(description="name of the model, a key of `models`")
    faces: int = Field(
        5500, ge=4, description="faces that quadric edge collapse leaves; the paper's are 5,500"
    )
