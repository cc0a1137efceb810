"""Options of the ground-truth row, without torch."""

from typing import Literal

from pydantic import Field

from tetgan.models.method import Method, MethodOptions


class RepresentationOptions(MethodOptions):
    """Ground-truth fields in place of a model: the best that any model on the grid can do."""

    kind: Literal["representation"]
    grid: str = Field(description="name of the grid, a key of `grids`")


METHOD = Method(
    RepresentationOptions,
    build="tetgan.methods.representation.network:RepresentationGenerator",
    train="tetgan.training.fit:fit_model",
)
