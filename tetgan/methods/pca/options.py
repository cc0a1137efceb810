"""Options of PCA, without torch."""

from typing import Literal

from pydantic import Field

from tetgan.models.method import Method, MethodOptions


class PcaOptions(MethodOptions):
    """Principal components of the training fields: the linear yardstick."""

    kind: Literal["pca"]
    grid: str = Field(description="name of the grid, a key of `grids`")
    components: int = Field(64, ge=1, description="number of principal components kept")


METHOD = Method(
    PcaOptions,
    build="tetgan.methods.pca.network:PcaGenerator",
    train="tetgan.training.fit:fit_model",
    one_mode=True,
)
