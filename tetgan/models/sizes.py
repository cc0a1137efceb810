"""Sizes of models, their data and training, beside those of the paper (docs/fidelity.md)."""

from typing import Any, NamedTuple

from tetgan.fields.options import PointOptions, Sampling, VoxelOptions
from tetgan.grids.options import GridOptions
from tetgan.models.options import (
    KindOptions,
    OccNetOptions,
    ShapeGanOptions,
    ShapeGanVaeOptions,
    SimplifiedOptions,
    TetganOptions,
)


class Size(NamedTuple):
    """One of ours, and what it is in full: the paper's, or, where no source states it, our own."""

    ours: int | float
    full: int | float
    stated: bool = True

    @property
    def differs(self) -> bool:
        """Larger is no reduction."""
        return self.ours < self.full

    def __str__(self) -> str:
        return f"{self.ours:g} ({'paper' if self.stated else 'our full run'} {self.full:g})"


class Choice(NamedTuple):
    """One of ours that is no number, and the paper's."""

    ours: str
    full: str

    @property
    def differs(self) -> bool:
        return self.ours != self.full

    def __str__(self) -> str:
        return f"{self.ours} (paper {self.full})"


Sizes = dict[str, Size | Choice]


def of_data(options: KindOptions, data: GridOptions | Sampling, training: Any) -> Sizes:
    """Of a model of which the paper says nothing, the grid's alone."""
    return {"depth": Size(data.depth, 3)} if isinstance(data, GridOptions) else {}


def of_tetgan(options: TetganOptions, grid: GridOptions, training: Any) -> Sizes:
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


def of_occnet(options: OccNetOptions, sampling: PointOptions, training: Any) -> Sizes:
    """Its public code's, which trains as long as one likes."""
    return {
        "points": Size(sampling.count, 100_000),
        "points a step": Size(training.points, 2048),
        "cells a side": Size(options.mise_start * 2**options.mise_steps, 128),
        "epochs": Size(training.epochs, 1000, stated=False),
        "batch": Size(training.batch_size, 64),
    }


def of_shapegan(options: ShapeGanOptions, sampling: VoxelOptions, training: Any) -> Sizes:
    """Its public code's; epochs are those of all stages: 8 voxels a side, 16, ..."""
    stages = (sampling.resolution // 4).bit_length() - 1
    epochs = sum(training.epochs) if isinstance(training.epochs, list) else stages * training.epochs
    return {
        "voxels a side": Size(sampling.resolution, 64),
        "cells a side": Size(options.resolution, 64),
        "epochs": Size(epochs, 1000),
        "fade-in epochs": Size(training.fade_in, 10),
        "batch": Size(training.batch_size, 16),
    }


def of_shapegan_vae(options: ShapeGanVaeOptions, sampling: VoxelOptions, training: Any) -> Sizes:
    """Its public code's, which trains as long as one likes."""
    return {
        "voxels a side": Size(sampling.resolution, 32),
        "epochs": Size(training.epochs, 500, stated=False),
        "batch": Size(training.batch_size, 32),
    }


def of_simplified(options: SimplifiedOptions, data: None, training: None) -> Sizes:
    """Beside those of the model that it is made from."""
    return {"faces": Size(options.faces, 5500)}
