"""Options of TetGAN and of its training, without torch. The defaults are the paper's."""

from typing import Any, ClassVar, Literal

from pydantic import Field

from tetgan.grids.options import GridOptions
from tetgan.models.method import Choice, Method, MethodOptions, Size, Sizes, of_data
from tetgan.training.options import CommonTraining


class TetganOptions(MethodOptions):
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


def sizes(options: TetganOptions, grid: GridOptions, training: Any) -> Sizes:
    """The paper's and its official code's."""
    return of_data(options, grid, training) | {
        "width": Size(options.width, 64),
        "code": Size(options.code, 512),
        "local critic width": Size(options.local_critic_width, 16),
        "global critic width": Size(options.global_critic_width, 64),
        "prior": Choice(options.prior, "normal"),
        "epochs": Size(training.epochs, 100),
        "batch": Size(training.batch_size, 30),
    }


class TetganTraining(CommonTraining):
    """TetGAN: losses, schedule and optimisers."""

    may_change: ClassVar[frozenset[str]] = CommonTraining.may_change | {
        *("accumulate", "checkpointing", "fields", "picture_every")
    }

    epochs: int = Field(100, ge=1, description="passes over the training split")
    batch_size: int = Field(30, ge=1, description="shapes a step")
    learning_rate: float = Field(1e-4, gt=0, description="Adam's step size for the autoencoder")
    critic_learning_rate: float = Field(1e-4, gt=0, description="Adam's step size for both critics")
    betas: tuple[float, float] = Field(
        (0.0, 0.9), description="decay rates of the two moments of Adam, for the autoencoder and the critics"
    )
    adversarial_learning_rate: float | None = Field(
        None,
        gt=0,
        description="Adam's step size for the adversarial step, whose length the critics' weights do not "
        "change; empty: `learning_rate`",
    )
    adversarial_betas: tuple[float, float] = Field(
        (0.0, 0.9), description="the same for the adversarial steps, which have moments of their own"
    )
    decay: Literal["constant", "cosine"] = Field(
        "constant",
        description="course of the autoencoder's step size: constant, or a half cosine down to a hundredth",
    )
    gradient_clip: float | None = Field(
        None, gt=0, description="largest gradient norm of the autoencoder; empty: no clipping"
    )

    head_start: float = Field(
        0.0,
        ge=0,
        lt=1,
        description="share of the epochs that go around the latent head; it then starts from their features",
    )
    positive_weight: float = Field(1.0, gt=0, description="weight of occupied tets in the cross-entropy")
    displacement_weight: float = Field(1.0, ge=0, description="weight of the displacement loss")
    displacement_loss: Literal["squared", "relative"] = Field(
        "squared",
        description="error of vertex displacements: squared, in units of their range, which the far field "
        "dominates; or relative, |ΔD|² / (|D|² + (2μ)²) with the μ of Eq. 5",
    )
    kl_weight: float = Field(1.0, ge=0, description="weight towards which the KL term rises")
    kl_decay: float = Field(
        0.9935,
        ge=0,
        lt=1,
        description="how much of the rise is left after 5,648 shapes; smaller rises faster",
    )

    local_weight: float = Field(
        4.0, description="weight of the local critic's score; 0 leaves it out, below 0 lowers the score"
    )
    global_weight: float = Field(
        0.01, description="weight of the global critic's score; likewise (the official code has -0.01)"
    )
    critic_steps: int = Field(3, ge=1, description="critic batches for each adversarial generator batch")
    gradient_penalty: float = Field(10.0, ge=0, description="weight of the critics' gradient penalty")
    adversarial_start: float = Field(
        0.0, ge=0, le=1, description="share of the epochs before the adversarial training begins; 1: never"
    )
    adversarial_every: int = Field(1, ge=1, description="autoencoder steps for each adversarial round")

    ema: float | None = Field(
        None, gt=0, lt=1, description="decay of the running mean of the weights that is kept; empty: none"
    )
    precision: Literal["fp32", "bf16"] = Field(
        "fp32",
        description="number format of the networks; bf16 leaves statistics, losses and the penalty in "
        "single precision, and is slow on most CPUs",
    )
    accumulate: int = Field(
        1, ge=1, description="parts that a batch is computed in, one after the other, to save memory"
    )
    checkpointing: bool = Field(
        False,
        description="compute features again for the backward pass rather than keep them, to save memory",
    )
    fields: Literal["auto", "resident", "streamed"] = Field(
        "auto",
        description="fields stay in the device's memory (resident) or are read from disk ahead of use "
        "(streamed); auto: resident where they take up a quarter of that memory at most",
    )
    picture_every: int = Field(50, ge=1, description="epochs between two pictures of decoded shapes")


METHOD = Method(
    TetganOptions,
    build="tetgan.methods.tetgan.network:TetganGenerator",
    learner="tetgan.methods.tetgan.training:TetganRun",
    training=TetganTraining,
    sizes=sizes,
    shares_batches=True,
)
