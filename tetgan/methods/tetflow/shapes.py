"""Shapes on their active sets: what the autoencoder sees of a field, and batches of it."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Float16, Float32, Int
from torch import Tensor

from tetgan.grids.active import CHILDREN, ActiveLevel, Adjacency, active_levels, adjacencies
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.nn.sparse import ActiveNeighbors


@dataclass(frozen=True, eq=False)
class ActiveShape:
    """A field on the tets near its surface.

    Attributes:
        levels: coarse to fine.
        shares: of each level (N,) the occupied share of the finest tets inside.
        distance: (N,) of the finest active tets, signed, negative inside, in units of the reach.
        normal: (N, 3) of the surface nearest to them, outward.
    """

    levels: list[ActiveLevel]
    shares: list[Float16[np.ndarray, "_N"]]
    distance: Float16[np.ndarray, "N"]
    normal: Float16[np.ndarray, "N 3"]

    @property
    def digest(self) -> bytes:
        """SHA-256 of the numbers that a network sees."""
        sha = hashlib.sha256()
        for array in (*(level.cells for level in self.levels), *self.shares, self.distance, self.normal):
            sha.update(array.tobytes())
        return sha.digest()


class ActiveSets:
    """Makes active shapes of the fields on a hierarchy.

    Attributes:
        around: neighbours at every level.
        reach: in cube sides; finest tets nearer to the surface are active.
    """

    def __init__(self, hierarchy: GridHierarchy, reach: float) -> None:
        """`reach` is in cube roots of a finest tet's mean volume."""
        self.around: list[Adjacency] = adjacencies(hierarchy)
        self.reach = reach * float(hierarchy.finest.volumes.mean()) ** (1 / 3)

    def shape(
        self, occupancy: Bool[np.ndarray, "T"], displacement: Float32[np.ndarray, "T 3"]
    ) -> ActiveShape:
        """The active shape of a field; its displacement in cube sides."""
        length = np.linalg.norm(displacement, axis=1)
        levels = active_levels(self.around, length < self.reach)
        shares = [occupancy.astype(np.float16)]
        for _ in levels[1:]:
            shares.insert(
                0, shares[0].reshape(-1, CHILDREN).mean(axis=1, dtype=np.float32).astype(np.float16)
            )
        finest = levels[-1].cells
        side = np.where(occupancy[finest], np.float32(-1), np.float32(1))
        outward = -side[:, None] * displacement[finest]
        return ActiveShape(
            levels,
            [share[level.cells] for share, level in zip(shares, levels, strict=True)],
            (side * length[finest] / np.float32(self.reach)).astype(np.float16),
            (outward / np.maximum(length[finest, None], 1e-6)).astype(np.float16),
        )


class BatchLevel(NamedTuple):
    """One level of several shapes, one after the other.

    Attributes:
        share: (N,) occupied share.
        split: (N,) 1 where the children are active.
        parents: rows of the tets that are split.
    """

    neighbors: ActiveNeighbors
    share: Float[Tensor, "N"]
    split: Float[Tensor, "N"]
    parents: Int[Tensor, "P"]


class ActiveBatch(NamedTuple):
    """Several active shapes, on a device; distance and normal as in `ActiveShape`."""

    shapes: int
    levels: list[BatchLevel]
    distance: Float[Tensor, "N"]
    normal: Float[Tensor, "N 3"]


def collate(shapes: Sequence[ActiveShape], device: torch.device) -> ActiveBatch:
    """Put shapes one after the other."""
    levels = zip(*(shape.levels for shape in shapes), strict=True)
    shares = zip(*(shape.shares for shape in shapes), strict=True)
    return ActiveBatch(
        len(shapes),
        [_level(*both, device) for both in zip(levels, shares, strict=True)],
        _floats([shape.distance for shape in shapes], device),
        _floats([shape.normal for shape in shapes], device),
    )


def _level(
    levels: Sequence[ActiveLevel], shares: Sequence[Float16[np.ndarray, "_N"]], device: torch.device
) -> BatchLevel:
    first = np.cumsum([0, *(len(level.cells) for level in levels)], dtype=np.int32)[:-1]
    neighbors = [
        np.where(level.neighbors < 0, np.int32(-1), level.neighbors + start)
        for level, start in zip(levels, first, strict=True)
    ]
    parents = [level.parents + start for level, start in zip(levels, first, strict=True)]
    return BatchLevel(
        neighbor_tensors(np.concatenate(neighbors), np.concatenate([level.back for level in levels]), device),
        _floats(shares, device),
        _floats([level.split for level in levels], device),
        torch.from_numpy(np.concatenate(parents)).to(device),
    )


def neighbor_tensors(
    neighbors: Int[np.ndarray, "N 4"], back: Int[np.ndarray, "N 4"], device: torch.device
) -> ActiveNeighbors:
    """Tables of `ActiveLevel` as a convolution takes them."""
    return ActiveNeighbors.of_table(*(torch.from_numpy(table).to(device) for table in (neighbors, back)))


def _floats(parts: Sequence[np.ndarray], device: torch.device) -> Tensor:
    return torch.from_numpy(np.concatenate(parts)).to(device).float()
