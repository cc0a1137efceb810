"""One Zarr file per shard, with named arrays of its shapes."""

import shutil
import tempfile
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from zarr.storage import LocalStore, ZipStore

from tetgan.errors import UserError
from tetgan.files import whole_file

Arrays = Mapping[str, np.ndarray]


def write_arrays(
    path: str | Path, ids: list[str], shapes: Iterable[Arrays], attributes: Mapping[str, Any], noun: str
) -> None:
    """Write the arrays of `ids`, in that order; the same input gives the same bytes.

    One chunk a shape and name; every shape has arrays of the same names, sizes and types. `shapes` may be a
    generator: one is in memory at a time. A shard without shapes has no arrays.

    Raises:
        ValueError: not as many shapes as ids.
    """
    with tempfile.TemporaryDirectory() as folder, whole_file(path) as partial:
        group = zarr.create_group(LocalStore(Path(folder)), attributes={"ids": ids, **attributes})
        count = 0
        for arrays in shapes:
            if count == 0:
                targets = {name: _create(group, name, len(ids), array) for name, array in arrays.items()}
            if count < len(ids):
                for name, array in arrays.items():
                    targets[name][count] = array
            count += 1
        if count != len(ids):
            raise ValueError(f"{count} {noun}s for {len(ids)} ids")
        _pack(Path(folder), partial)


class ArrayReader:
    """The shapes of one shard file.

    Attributes:
        ids: in the order of the shard.
        attributes: what else was written of the shard.

    Args:
        dimensions: of each array of one shape, by name.
        noun: what the shard holds, for messages.

    Raises:
        UserError: on opening or reading, the file is missing, damaged or not such a shard.
    """

    def __init__(self, path: str | Path, dimensions: Mapping[str, int], noun: str) -> None:
        self._path, self._noun = Path(path), noun
        with self._readable():
            group = zarr.open_group(ZipStore(self._path, mode="r"), mode="r")
            self.attributes = dict(group.attrs)
            self.ids = _text_list(self.attributes.pop("ids"))
            names = dimensions if self.ids else {}
            self._arrays = {name: _array(group, name, len(self.ids), dimensions[name]) for name in names}
        self._rows = {shape_id: row for row, shape_id in enumerate(self.ids)}

    def read(self, shape_id: str) -> dict[str, np.ndarray]:
        """One shape's arrays, by name.

        Raises:
            KeyError: no such shape here.
        """
        row = self._rows[shape_id]
        with self._readable():
            return {name: np.asarray(array[row]) for name, array in self._arrays.items()}

    @contextmanager
    def _readable(self) -> Iterator[None]:
        try:
            yield
        except (OSError, zipfile.BadZipFile, KeyError, ValueError, TypeError, RuntimeError) as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            remedy = f"make the {self._noun}s of this shard again"
            raise UserError(f"{self._path}: not a whole {self._noun} shard ({reason}); {remedy}") from None


def _text_list(value: object) -> list[str]:
    if not isinstance(value, list):
        raise TypeError(f"ids are {value!r}")
    return [str(item) for item in value]


def _array(group: zarr.Group, name: str, shapes: int, dimensions: int) -> zarr.Array[Any]:
    array = group[name]
    if not isinstance(array, zarr.Array) or array.ndim != 1 + dimensions:
        raise ValueError(f"{name} is not an array of {1 + dimensions} dimensions")
    if array.shape[0] != shapes:
        raise ValueError(f"{name} has shape {array.shape}")
    return array


def _create(group: zarr.Group, name: str, shapes: int, first: np.ndarray) -> zarr.Array[Any]:
    chunk = tuple(max(size, 1) for size in first.shape)  # Zarr wants no chunk of length 0
    return group.create_array(name, shape=(shapes, *first.shape), chunks=(1, *chunk), dtype=first.dtype)


def _pack(folder: Path, path: Path) -> None:
    """Zip a folder. Zarr's own ZipStore stamps the time on every entry, so no two runs would agree."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for source in sorted(item for item in folder.rglob("*") if item.is_file()):
            entry = zipfile.ZipInfo(source.relative_to(folder).as_posix())  # dated 1980-01-01
            entry.external_attr = 0o644 << 16
            with source.open("rb") as stream, archive.open(entry, "w") as sink:
                shutil.copyfileobj(stream, sink)
