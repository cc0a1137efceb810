"""The fields of a category, over all its shards, as one data set."""

import csv
import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float32
from pydantic import Field as OptionField
from pydantic import ValidationError

from tetgan.errors import UserError
from tetgan.fields.field import Field, surface_tets
from tetgan.fields.shard import ShardReader, write_shard
from tetgan.files import whole_file
from tetgan.grids.build import grid_from_options
from tetgan.grids.hierarchy import GridHierarchy
from tetgan.grids.options import GridOptions
from tetgan.options import Options

__all__ = ["FieldBatch", "FieldStore", "index_fields", "write_shard"]

Split = Literal["train", "validation"]


class _ShardEntry(Options):
    """A shard file, relative to the index, and the split of each of its shapes."""

    file: str
    shapes: dict[str, str]


class _Index(Options):
    """What `index.json` holds."""

    grid: GridOptions
    grid_digest: str
    mu: float = OptionField(ge=0)
    max_displacement: float = OptionField(gt=0)
    shards: list[_ShardEntry]


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
        UserError: a shard is damaged or of another grid, a shape stands in two shards or not in the
            catalogue, or there is no training shape.
    """
    hierarchy = grid_from_options(grid)
    readers = {path: _open_shard(path, hierarchy.digest) for path in shards}
    splits = _splits_of(readers, catalogue)
    means, longest = [], []
    for reader in readers.values():
        for shape_id in reader.ids:
            if splits[shape_id] == "train":
                mean, maximum = _displacement_sizes(reader.read(shape_id), hierarchy)
                longest.append(maximum)
                means += [mean] if mean is not None else []
    if not means:
        raise UserError(
            f"{catalogue}: no training shape with a surface in any shard; add shapes to the source"
        )
    entries = [
        _ShardEntry(
            file=Path(os.path.relpath(path, out.parent)).as_posix(),
            shapes={shape_id: splits[shape_id] for shape_id in reader.ids},
        )
        for path, reader in readers.items()
    ]
    index = _Index(
        grid=grid,
        grid_digest=hierarchy.digest,
        mu=float(np.mean(means)),
        max_displacement=float(max(longest)),
        shards=entries,
    )
    with whole_file(out) as partial:
        partial.write_text(index.model_dump_json(indent=1, exclude_none=True) + "\n", encoding="utf-8")


class FieldStore:
    """Random access to the fields of a category, shape by shape."""

    def __init__(self, path: Path, index: _Index) -> None:
        self._path, self._index = path, index
        self._split = {shape: split for entry in index.shards for shape, split in entry.shapes.items()}
        self._file = {shape: entry.file for entry in index.shards for shape in entry.shapes}
        self._readers: dict[str, ShardReader] = {}

    @classmethod
    def open(cls, index_path: str | Path) -> "FieldStore":
        """Open the data set of an `index.json`; shards are opened when first read.

        Raises:
            UserError: the index is missing or malformed.
        """
        path = Path(index_path)
        try:
            return cls(path, _Index.model_validate_json(path.read_text(encoding="utf-8")))
        except (OSError, UnicodeDecodeError, ValidationError) as error:
            reason = error.errors()[0]["msg"] if isinstance(error, ValidationError) else error
            raise UserError(f"{path}: not an index of fields ({reason}); run the index stage again") from None

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

    def ids(self, split: Split) -> list[str]:
        """The shapes of a split, sorted."""
        return sorted(shape_id for shape_id, of in self._split.items() if of == split)

    def read(self, shape_id: str) -> Field:
        """One shape.

        Raises:
            KeyError: no such shape.
            UserError: its shard is damaged, or no longer the one that was indexed.
        """
        file = self._file[shape_id]
        if file not in self._readers:
            reader = _open_shard(self._path.parent / file, self._index.grid_digest)
            if not set(self._ids_in(file)) <= set(reader.ids):
                raise UserError(f"{self._path}: {file} has changed since; run the index stage again")
            self._readers[file] = reader
        return self._readers[file].read(shape_id)

    def stack(self, ids: Sequence[str]) -> FieldBatch:
        """Several shapes, in the order of `ids`."""
        shape = (len(ids), len(self.hierarchy.finest.tets))
        batch = FieldBatch(np.empty(shape, dtype=bool), np.empty((*shape, 3), dtype=np.float32))
        for row, shape_id in enumerate(ids):
            field = self.read(shape_id)
            batch.occupancy[row], batch.displacement[row] = field.occupancy, field.displacement
        return batch

    def tensor(self, ids: Sequence[str]) -> Float32[np.ndarray, "B T 4"]:
        """What the networks read: occupancy 0 or 1, then displacement / `max_displacement` within [-1, 1]."""
        tensor = np.empty((len(ids), len(self.hierarchy.finest.tets), 4), dtype=np.float32)
        for row, shape_id in zip(tensor, ids, strict=True):
            field = self.read(shape_id)
            row[:, 0] = field.occupancy
            row[:, 1:] = field.displacement / np.float32(self.max_displacement)
        return np.clip(tensor, -1, 1, out=tensor)

    def _ids_in(self, file: str) -> list[str]:
        return [shape_id for shape_id, other in self._file.items() if other == file]


def _open_shard(path: Path, grid_digest: str) -> ShardReader:
    reader = ShardReader(path)
    if reader.ids and reader.grid_digest != grid_digest:
        raise UserError(f"{path}: made on another grid; extract the fields of this shard again")
    return reader


def _splits_of(readers: dict[Path, ShardReader], catalogue: Path) -> dict[str, str]:
    """The split of every shape in the shards, each of which must be known and stand in one shard only."""
    known = _read_splits(catalogue)
    splits: dict[str, str] = {}
    for path, reader in readers.items():
        for shape_id in reader.ids:
            if shape_id not in known:
                raise UserError(
                    f"{path}: shape '{shape_id}' is not in {catalogue}; gather the catalogue again"
                )
            if shape_id in splits:
                raise UserError(f"{path}: shape '{shape_id}' also stands in another shard")
            splits[shape_id] = known[shape_id]
    return splits


def _read_splits(catalogue: Path) -> dict[str, str]:
    try:
        with catalogue.open(encoding="utf-8", newline="") as stream:
            return {row["id"]: row["split"] for row in csv.DictReader(stream)}
    except (OSError, UnicodeDecodeError, csv.Error, KeyError) as error:
        raise UserError(f"{catalogue}: not a catalogue with columns id and split ({error})") from None


def _displacement_sizes(field: Field, hierarchy: GridHierarchy) -> tuple[float | None, float]:
    """Mean length over the surface tets (none without them) and greatest length over all tets."""
    lengths = np.linalg.norm(field.displacement.astype(np.float64), axis=1)
    surface = surface_tets(field.occupancy, hierarchy.finest.neighbors)
    return (float(lengths[surface].mean()) if surface.any() else None), float(lengths.max())
