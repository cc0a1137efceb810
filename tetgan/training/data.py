"""A split of a field store, held in memory."""

import hashlib
from typing import Literal

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from tetgan.fields.store import FieldStore

CHUNK = 64  # shapes converted at a time, so that single precision never holds the whole split


class FieldData:
    """The fields of one split: a byte and three half-precision numbers a tet."""

    def __init__(self, store: FieldStore, split: Literal["train", "validation"]) -> None:
        self.ids = store.ids(split)
        occupancy, displacement = [], []
        for start in range(0, len(self.ids), CHUNK):
            chunk = torch.from_numpy(store.tensor(self.ids[start : start + CHUNK]))
            occupancy.append(chunk[..., 0] > 0.5)
            displacement.append(chunk[..., 1:].half())
        self.occupancy = torch.cat(occupancy) if occupancy else torch.empty(0, 0, dtype=torch.bool)
        self.displacement = torch.cat(displacement) if displacement else torch.empty(0, 0, 3).half()

    def __len__(self) -> int:
        return len(self.ids)

    def batch(self, rows: Int[Tensor, "B"], device: torch.device) -> Float[Tensor, "B T 4"]:
        """The network tensor of some shapes, by their place in `ids`."""
        occupancy = self.occupancy[rows].to(device).float()
        return torch.cat([occupancy[..., None], self.displacement[rows].to(device).float()], dim=-1)

    def tets(self, part: slice) -> Float[np.ndarray, "N t 4"]:
        """All shapes, but some tets only."""
        occupancy = self.occupancy[:, part, None].numpy().astype(np.float32)
        return np.concatenate([occupancy, self.displacement[:, part].numpy().astype(np.float32)], axis=-1)

    @property
    def digest(self) -> str:
        """SHA-256 of ids and fields."""
        sha = hashlib.sha256("\n".join(self.ids).encode())
        for array in (self.occupancy, self.displacement):
            sha.update(np.ascontiguousarray(array.numpy()).data)
        return sha.hexdigest()
