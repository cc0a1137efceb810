"""The fields of a category, over all its shards, as one data set."""

from collections.abc import Iterable, Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32
from pydantic import Field as OptionField

from tetgan.errors import UserError
from tetgan.fields.arrays import ArrayReader, write_arrays
from tetgan.fields.dataset import ShardedStore, ShardIndex, enter_shards, read_index, write_index
from tetgan.fields.field import Field, surface_tets
from tetgan.grids.hierarchy import GridHierarchy, grid_from_options
from tetgan.grids.options import GridOptions


def write_shard(path: str | Path, ids: list[str], fields: Iterable[Field], grid_digest: str) -> None:
    """Write the fields of `ids`, in that order; the same input gives the same bytes.

    Displacement is kept as float16, 5e-4 of its size. `fields` may be a generator: one is in memory at a
    time.

    Raises:
        ValueError: not as many fields as ids.
    """
    shapes = (
        {"occupancy": field.occupancy, "displacement": field.displacement.astype(np.float16)}
        for field in fields
    )
    write_arrays(path, ids, shapes, {"grid_digest": grid_digest}, "field")


class ShardReader:
    """The shapes of one shard file.

    Attributes:
        ids: in the order of the shard.
        grid_digest: of the hierarchy that the fields were extracted on.

    Raises:
        UserError: on opening or reading, the file is missing, damaged or no field shard.
    """

    def __init__(self, path: str | Path) -> None:
        self._reader = ArrayReader(path, {"occupancy": 1, "displacement": 2}, "field")
        self.ids = self._reader.ids
        self.grid_digest = str(self._reader.attributes.get("grid_digest"))

    def read(self, shape_id: str) -> Field:
        """One shape's field.

        Raises:
            KeyError: no such shape here.
        """
        arrays = self._reader.read(shape_id)
        return Field(arrays["occupancy"], arrays["displacement"].astype(np.float32))


__all__ = ["FieldBatch", "FieldStore", "index_fields", "write_shard"]


class _Index(ShardIndex):
    """What `index.json` holds."""

    grid: GridOptions
    grid_digest: str
    mu: float = OptionField(ge=0)
    max_displacement: float = OptionField(gt=0)


class FieldBatch(NamedTuple):
    """Fields of several shapes; see `Field`."""

    occupancy: Bool[np.ndarray, "B T"]
    displacement: Float32[np.ndarray, "B T 3"]


def index_fields(shards: Sequence[Path], catalogue: Path, grid: GridOptions, out: Path) -> None:
    """Join shards into one data set: write the `index.json` that `FieldStore` opens.

    It keeps two numbers of the training shapes: `mu` of Eq. 5, the mean length of the displacement over a
    shape's surface tets, averaged over the shapes that have any; and `max_displacement`, the longest over
    all their tets.

    Args:
        shards: field shards; some may be empty.
        catalogue: CSV with columns `id` and `split`; only shapes that are in a shard count.
        grid: the options that the fields were extracted with.

    Raises:
        UserError: a shard is damaged or of another grid, a shape is in two shards or not in the
            catalogue, or there is no training shape.
    """
    hierarchy = grid_from_options(grid)
    readers = {path: _open_shard(path, hierarchy.digest) for path in shards}
    entries = enter_shards(readers, catalogue, out)
    means, longest = [], []
    for entry, reader in zip(entries, readers.values(), strict=True):
        for shape_id, split in entry.shapes.items():
            if split == "train":
                mean, maximum = _displacement_sizes(reader.read(shape_id), hierarchy)
                longest.append(maximum)
                means += [mean] if mean is not None else []
    if not means:
        raise UserError(
            f"{catalogue}: no training shape with a surface in any shard; add shapes to the source"
        )
    index = _Index(
        grid=grid,
        grid_digest=hierarchy.digest,
        mu=float(np.mean(means)),
        max_displacement=float(max(longest)),
        shards=entries,
    )
    write_index(index, out)


class FieldStore(ShardedStore[Field]):
    """Random access to the fields of a category, shape by shape."""

    def __init__(self, path: Path, index: _Index) -> None:
        super().__init__(path, index)
        self._index = index

    @classmethod
    def open(cls, index_path: str | Path) -> "FieldStore":
        """Open the data set of an `index.json`; shards are opened when first read.

        Raises:
            UserError: the index is missing or malformed.
        """
        path = Path(index_path)
        return cls(path, read_index(path, _Index, "field"))

    @property
    def grid(self) -> GridOptions:
        """The grid the fields were extracted on."""
        return self._index.grid

    @property
    def mu(self) -> float:
        """Eq. 5's mean displacement of surface tets, over the training shapes, in cube sides."""
        return self._index.mu

    @property
    def max_displacement(self) -> float:
        """Longest displacement over the training shapes, in cube sides."""
        return self._index.max_displacement

    @cached_property
    def hierarchy(self) -> GridHierarchy:
        """The grids themselves.

        Raises:
            UserError: the options no longer give the grid the fields were extracted on.
        """
        hierarchy = grid_from_options(self.grid)
        if hierarchy.digest != self._index.grid_digest:
            raise UserError(f"{self._path}: the grid has changed since; extract the fields again")
        return hierarchy

    def read(self, shape_id: str) -> Field:
        """One shape.

        Raises:
            KeyError: no such shape.
            UserError: its shard is damaged, or no longer the one that was indexed.
        """
        return self._read(shape_id)

    def stack(self, ids: Sequence[str]) -> FieldBatch:
        """Several shapes, in the order of `ids`."""
        shape = (len(ids), len(self.hierarchy.finest.tets))
        batch = FieldBatch(np.empty(shape, dtype=bool), np.empty((*shape, 3), dtype=np.float32))
        for row, shape_id in enumerate(ids):
            field = self.read(shape_id)
            batch.occupancy[row], batch.displacement[row] = field.occupancy, field.displacement
        return batch

    def tensor(self, ids: Sequence[str]) -> Float32[np.ndarray, "B T 4"]:
        """Input of the networks: occupancy 0 or 1, then displacement / `max_displacement` within [-1, 1]."""
        tensor = np.empty((len(ids), len(self.hierarchy.finest.tets), 4), dtype=np.float32)
        for row, shape_id in zip(tensor, ids, strict=True):
            field = self.read(shape_id)
            row[:, 0] = field.occupancy
            row[:, 1:] = field.displacement / np.float32(self.max_displacement)
        return np.clip(tensor, -1, 1, out=tensor)

    def write_without_shapes(self, out: Path) -> None:
        """Write an index that knows the grid and both numbers, and no shape: all that decoding takes."""
        write_index(self._index.model_copy(update={"shards": []}), out)

    def _open_shard(self, path: Path) -> ShardReader:
        return _open_shard(path, self._index.grid_digest)


def _open_shard(path: Path, grid_digest: str) -> ShardReader:
    reader = ShardReader(path)
    if reader.ids and reader.grid_digest != grid_digest:
        raise UserError(f"{path}: made on another grid; extract the fields of this shard again")
    return reader


def _displacement_sizes(field: Field, hierarchy: GridHierarchy) -> tuple[float | None, float]:
    """Mean length over the surface tets (none without them) and greatest length over all tets."""
    lengths = np.linalg.norm(field.displacement.astype(np.float64), axis=1)
    surface = surface_tets(field.occupancy, hierarchy.finest.neighbors)
    return (float(lengths[surface].mean()) if surface.any() else None), float(lengths.max())
