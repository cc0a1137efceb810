"""Pooling from eight children to their parent, and upsampling from parents to children."""

from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy import sparse
from torch import Tensor, nn

from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import upsampling_weights
from tetgan.nn.rows import RowMap

CHILDREN = 8


class TetPool(nn.Module):
    """The largest or the mean feature of each eight children; they are neighbors in memory."""

    def __init__(self, kind: Literal["max", "mean"] = "max") -> None:
        super().__init__()
        self.kind = kind

    def forward(self, x: Float[Tensor, "T B C"]) -> Float[Tensor, "T/8 B C"]:
        children = x.unflatten(0, (-1, CHILDREN))
        return children.max(dim=1).values if self.kind == "max" else children.mean(dim=1)


class TetUpsample(nn.Module):
    """Features of a coarse grid on its subdivision.

    `inverse_distance`: each child averages its parent and the parent's neighbors by inverse distance of
    centroids. `copy`: each child takes its parent's features.
    """

    def __init__(
        self, coarse: TetGrid, fine: TetGrid, kind: Literal["inverse_distance", "copy"] = "inverse_distance"
    ) -> None:
        super().__init__()
        self.rows = RowMap(_copies(coarse) if kind == "copy" else _averages(coarse, fine))

    def forward(self, x: Float[Tensor, "T B C"]) -> Float[Tensor, "8*T B C"]:
        return self.rows(x)


def _copies(coarse: TetGrid) -> sparse.csr_array:
    parents = np.arange(len(coarse.tets)).repeat(CHILDREN)
    return sparse.csr_array((np.ones(len(parents)), (np.arange(len(parents)), parents)))


def _averages(coarse: TetGrid, fine: TetGrid) -> sparse.csr_array:
    """(8T, T) from the (T, 8, 5) weights of a parent and its neighbors."""
    weights = upsampling_weights(coarse, fine)
    sources = np.concatenate([np.arange(len(coarse.tets))[:, None], coarse.neighbors], axis=1)
    columns = np.broadcast_to(sources[:, None], weights.shape)
    children = np.arange(weights[..., 0].size).reshape(*weights.shape[:2], 1)
    rows = np.broadcast_to(children, weights.shape)
    present = columns >= 0
    return sparse.csr_array(
        (weights[present], (rows[present], columns[present])), shape=(len(fine.tets), len(coarse.tets))
    )
