"""The shards of a category as one data set: the index over them, and reading through it."""

import csv
import os
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Generic, Literal, Protocol, TypeVar, runtime_checkable

from pydantic import ValidationError

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.options import Options

Split = Literal["train", "validation"]

Shape_co = TypeVar("Shape_co", covariant=True)


class ShardEntry(Options):
    """A shard file, relative to the index, and the split of each of its shapes."""

    file: str
    shapes: dict[str, str]


class ShardIndex(Options):
    """Contents common to every `index.json`."""

    shards: list[ShardEntry]


Index = TypeVar("Index", bound=ShardIndex)


@runtime_checkable
class Reader(Protocol[Shape_co]):
    """An open shard."""

    ids: list[str]

    def read(self, shape_id: str) -> Shape_co:
        """One shape.

        Raises:
            KeyError: no such shape here.
        """


def enter_shards(readers: Mapping[Path, Reader[Any]], catalogue: Path, out: Path) -> list[ShardEntry]:
    """The entries of an index to be written at `out`.

    Args:
        catalogue: CSV with columns `id` and `split`; only shapes that are in a shard count.

    Raises:
        UserError: a shape is in two shards or not in the catalogue.
    """
    splits = _splits_of(readers, catalogue)
    return [
        ShardEntry(
            file=Path(os.path.relpath(path, out.parent)).as_posix(),
            shapes={shape_id: splits[shape_id] for shape_id in reader.ids},
        )
        for path, reader in readers.items()
    ]


def write_index(index: ShardIndex, out: Path) -> None:
    """Write an index as JSON, without what is empty in it."""
    with whole_file(out) as partial:
        partial.write_text(index.model_dump_json(indent=1, exclude_none=True) + "\n", encoding="utf-8")


def read_index(path: Path, kind: type[Index], noun: str) -> Index:
    """An index of a kind.

    Raises:
        UserError: the file is missing or is no such index.
    """
    try:
        return kind.model_validate_json(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, ValidationError) as error:
        reason = error.errors()[0]["msg"] if isinstance(error, ValidationError) else error
        raise UserError(f"{path}: not an index of {noun}s ({reason}); run the index stage again") from None


class ShardedStore(ABC, Generic[Shape_co]):
    """Random access to the shapes of a category; shards are opened when first read."""

    def __init__(self, path: Path, index: ShardIndex) -> None:
        self._path = path
        self._split = {shape: split for entry in index.shards for shape, split in entry.shapes.items()}
        self._file = {shape: entry.file for entry in index.shards for shape in entry.shapes}
        self._readers: dict[str, Reader[Shape_co]] = {}

    @abstractmethod
    def _open_shard(self, path: Path) -> Reader[Shape_co]:
        """Open a shard that the index names.

        Raises:
            UserError: it is damaged, or was made with other settings.
        """

    def ids(self, split: Split) -> list[str]:
        """The shapes of a split, sorted."""
        return sorted(shape_id for shape_id, of in self._split.items() if of == split)

    def _read(self, shape_id: str) -> Shape_co:
        """One shape, as its shard holds it.

        Raises:
            KeyError: no such shape.
            UserError: its shard is damaged, or no longer the one that was indexed.
        """
        file = self._file[shape_id]
        if file not in self._readers:
            reader = self._open_shard(self._path.parent / file)
            indexed = {shape for shape, other in self._file.items() if other == file}
            if not indexed <= set(reader.ids):
                raise UserError(f"{self._path}: {file} has changed since; run the index stage again")
            self._readers[file] = reader
        return self._readers[file].read(shape_id)


def _splits_of(readers: Mapping[Path, Reader[Any]], catalogue: Path) -> dict[str, str]:
    """The split of every shape in the shards, each of which must be known and in one shard only."""
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
