"""Points or voxels of one split, held in memory."""

from typing import Literal, Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32, Int
from torch import Tensor
from torch.nn import functional

from tetgan.fields.voxels import CLAMP

Split = Literal["train", "validation"]


@runtime_checkable
class PointSource(Protocol):
    """A `PointStore`, as far as training needs it."""

    @property
    def digest(self) -> str: ...

    def ids(self, split: Split) -> list[str]: ...

    def read(self, shape_id: str) -> tuple[Float32[np.ndarray, "N 3"], Bool[np.ndarray, "N"]]: ...


@runtime_checkable
class VoxelSource(Protocol):
    """A `VoxelStore`, as far as training needs it."""

    @property
    def digest(self) -> str: ...

    def ids(self, split: Split) -> list[str]: ...

    def read(self, shape_id: str) -> Float32[np.ndarray, "R R R"]: ...


class PointData:
    """Points and their occupancy: seven bytes a point, as stores keep half precision only."""

    def __init__(self, store: PointSource, split: Split) -> None:
        points, occupancy = [], []
        for shape_id in store.ids(split):
            positions, inside = store.read(shape_id)
            points.append(torch.from_numpy(positions).half())
            occupancy.append(torch.from_numpy(inside))
        self.points = torch.stack(points) if points else torch.empty(0, 0, 3).half()
        self.occupancy = torch.stack(occupancy) if occupancy else torch.empty(0, 0, dtype=torch.bool)

    def __len__(self) -> int:
        return len(self.points)

    def random(
        self, rows: Int[Tensor, "B"], count: int, draws: torch.Generator, device: torch.device
    ) -> Float[Tensor, "B N 4"]:
        """Random points of some shapes: position in the unit cube, then occupancy."""
        places = torch.randint(self.points.shape[1], (len(rows), count), generator=draws)
        return self._batch(rows, places, device)

    def first(self, rows: Int[Tensor, "B"], count: int, device: torch.device) -> Float[Tensor, "B N 4"]:
        """The same points every time."""
        places = torch.arange(min(count, self.points.shape[1])).expand(len(rows), -1)
        return self._batch(rows, places, device)

    def _batch(
        self, rows: Int[Tensor, "B"], places: Int[Tensor, "B N"], device: torch.device
    ) -> Float[Tensor, "B N 4"]:
        points, occupancy = self.points[rows[:, None], places], self.occupancy[rows[:, None], places]
        return torch.cat([points.to(device).float(), occupancy.to(device).float()[..., None]], dim=-1)


class VoxelData:
    """Signed distances in units of the clamp, -1 to 1: two bytes a voxel."""

    def __init__(self, store: VoxelSource, split: Split) -> None:
        voxels = [torch.from_numpy(store.read(shape_id) / CLAMP).half() for shape_id in store.ids(split)]
        self.voxels = torch.stack(voxels) if voxels else torch.empty(0, 0, 0, 0).half()

    def __len__(self) -> int:
        return len(self.voxels)

    @property
    def resolution(self) -> int:
        """Voxels along a side."""
        return self.voxels.shape[-1]

    def batch(
        self, rows: Int[Tensor, "B"], device: torch.device, resolution: int | None = None
    ) -> Float[Tensor, "B R R R"]:
        """Some shapes; at a lower resolution the distance at the centre of each larger voxel."""
        voxels = self.voxels[rows].to(device).float()
        if resolution in {None, self.resolution}:
            return voxels
        return functional.interpolate(voxels[:, None], size=3 * (resolution,), mode="trilinear")[:, 0]
