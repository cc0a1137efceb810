"""Training data on a device: fields, points and voxels of a split."""

import hashlib
import os
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cached_property
from pathlib import Path
from typing import Literal, NamedTuple, Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Bool, Float, Float16, Float32, Int
from torch import Tensor
from torch.nn import functional

from tetgan.errors import UserError
from tetgan.fields.dataset import Split
from tetgan.fields.store import FieldStore
from tetgan.fields.voxels import CLAMP


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


CHUNK = 64  # shapes converted at a time, so that single precision never holds the whole split

AHEAD = 2  # batches read before they are asked for

LARGEST_SHARE = 0.25  # of the device's memory that fields may take up

CPU = torch.device("cpu")

Placement = Literal["auto", "resident", "streamed"]


class PackedFields(NamedTuple):
    """Fields as they are kept and moved: a byte and three half-precision numbers a tet."""

    occupancy: Bool[Tensor, "B T"]
    displacement: Float16[Tensor, "B T 3"]

    def pinned(self) -> "PackedFields":
        """In memory that a GPU reads by itself."""
        return PackedFields(*(part.pin_memory() for part in self))

    def unpacked(self, device: torch.device) -> Float[Tensor, "B T 4"]:
        """Input of the networks, on their device; a GPU copies it asynchronously from pinned memory."""
        occupancy, displacement = (part.to(device, non_blocking=True) for part in self)
        return torch.cat([occupancy[..., None].float(), displacement.float()], dim=-1)


class FieldData(ABC):
    """The fields of one split."""

    def __init__(self, store: FieldStore, split: Split, device: torch.device = CPU) -> None:
        self.store, self.device, self.ids = store, device, store.ids(split)

    def __len__(self) -> int:
        return len(self.ids)

    @abstractmethod
    def batch(self, rows: Int[Tensor, "B"]) -> Float[Tensor, "B T 4"]:
        """The network tensor of some shapes, by their place in `ids`."""

    @abstractmethod
    def batches(self, plan: Iterable[Int[Tensor, "_B"]]) -> Iterator[Float[Tensor, "_B T 4"]]:
        """One batch after the other."""

    def _read(self, rows: Iterable[int]) -> PackedFields:
        tensor = torch.from_numpy(self.store.tensor([self.ids[row] for row in rows]))
        return PackedFields(tensor[..., 0] > 0.5, tensor[..., 1:].half())

    def _chunks(self) -> Iterator[PackedFields]:
        for start in range(0, len(self.ids), CHUNK):
            yield self._read(range(start, min(start + CHUNK, len(self.ids))))

    @cached_property
    def digest(self) -> str:
        """SHA-256 of ids and fields."""
        sha = hashlib.sha256("\n".join(self.ids).encode())
        for chunk in self._chunks():
            for array in chunk:
                sha.update(np.ascontiguousarray(array.numpy()).data)
        return sha.hexdigest()


class ResidentFields(FieldData):
    """Fields that stay in the memory of the device."""

    def __init__(self, store: FieldStore, split: Split, device: torch.device = CPU) -> None:
        super().__init__(store, split, device)
        chunks = list(super()._chunks())
        empty = PackedFields(torch.empty(0, 0, dtype=torch.bool), torch.empty(0, 0, 3).half())
        parts = zip(*chunks, strict=True) if chunks else ((part,) for part in empty)
        self.fields = PackedFields(*(torch.cat(part).to(device) for part in parts))

    def _chunks(self) -> Iterator[PackedFields]:
        for occupancy, displacement in zip(*(part.split(CHUNK) for part in self.fields), strict=True):
            yield PackedFields(occupancy.cpu(), displacement.cpu())

    def batch(self, rows: Int[Tensor, "B"]) -> Float[Tensor, "B T 4"]:
        rows = rows.to(self.device)
        return PackedFields(*(part[rows] for part in self.fields)).unpacked(self.device)

    def batches(self, plan: Iterable[Int[Tensor, "_B"]]) -> Iterator[Float[Tensor, "_B T 4"]]:
        return map(self.batch, plan)

    def tets(self, part: slice) -> Float[np.ndarray, "N t 4"]:
        """All shapes, but some tets only."""
        return PackedFields(*(values[:, part] for values in self.fields)).unpacked(CPU).numpy()


class StreamedFields(FieldData):
    """Fields that stay on disk; a thread reads the next batches while the device works on this one."""

    def batch(self, rows: Int[Tensor, "B"]) -> Float[Tensor, "B T 4"]:
        return self._load(rows).unpacked(self.device)

    def batches(self, plan: Iterable[Int[Tensor, "_B"]]) -> Iterator[Float[Tensor, "_B T 4"]]:
        waiting: deque[Future[PackedFields]] = deque()
        with ThreadPoolExecutor(1, thread_name_prefix="fields") as reader:
            for rows in plan:
                waiting.append(reader.submit(self._load, rows))
                if len(waiting) > AHEAD:
                    yield waiting.popleft().result().unpacked(self.device)
            while waiting:
                yield waiting.popleft().result().unpacked(self.device)

    def _load(self, rows: Int[Tensor, "B"]) -> PackedFields:
        fields = self._read(rows.tolist())
        return fields.pinned() if self.device.type == "cuda" else fields


def open_fields(store: FieldStore, split: Split, device: torch.device, placement: Placement) -> FieldData:
    """The fields of a split; `auto` keeps them on the device where they take up a quarter of it at most."""
    if placement == "auto":
        tets = len(store.hierarchy.finest.tets)
        needed = len(store.ids(split)) * tets * (1 + 3 * 2)
        placement = "resident" if needed <= LARGEST_SHARE * _memory(device) else "streamed"
    kind = ResidentFields if placement == "resident" else StreamedFields
    return kind(store, split, device)


def _memory(device: torch.device) -> int:
    """Bytes of the device."""
    if device.type == "cuda":
        return torch.cuda.get_device_properties(device).total_memory
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def open_training(index: Path) -> FieldStore:
    """The data set of an `index.json`.

    Raises:
        UserError: the index is missing or malformed, or no shape of it is for training.
    """
    store = FieldStore.open(index)
    if not store.ids("train"):
        raise UserError(f"{index}: no training shapes; add shapes to the source")
    return store
