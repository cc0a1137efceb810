"""One Zarr file with the fields of a shard of shapes."""

import shutil
import tempfile
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from zarr.storage import LocalStore, ZipStore

from tetgan.errors import UserError
from tetgan.fields.field import Field
from tetgan.files import whole_file


def write_shard(path: str | Path, ids: list[str], fields: Iterable[Field], grid_digest: str) -> None:
    """Write the fields of `ids`, in that order; the same input gives the same bytes.

    One chunk a shape; displacement is kept as float16, 5e-4 of its size. `fields` may be a generator: one
    is in memory at a time. An empty shard holds arrays of length 0.

    Raises:
        ValueError: not as many fields as ids.
    """
    with tempfile.TemporaryDirectory() as folder, whole_file(path) as partial:
        _write_group(Path(folder), ids, fields, grid_digest)
        _pack(Path(folder), partial)


class ShardReader:
    """The shapes of one shard file.

    Attributes:
        ids: in the order of the shard.
        grid_digest: of the hierarchy that the fields were extracted on.

    Raises:
        UserError: on opening or reading, the file is missing, damaged or no field shard.
    """

    def __init__(self, path: str | Path) -> None:
        self._path = Path(path)
        with self._readable():
            group = zarr.open_group(ZipStore(self._path, mode="r"), mode="r")
            self.ids = _text_list(group.attrs["ids"])
            self.grid_digest = str(group.attrs["grid_digest"])
            self._occupancy = _array(group, "occupancy", (len(self.ids), None))
            self._displacement = _array(group, "displacement", (*self._occupancy.shape, 3))
        self._rows = {shape_id: row for row, shape_id in enumerate(self.ids)}

    def read(self, shape_id: str) -> Field:
        """One shape's field.

        Raises:
            KeyError: no such shape here.
        """
        row = self._rows[shape_id]
        with self._readable():
            occupancy = np.asarray(self._occupancy[row])
            displacement = np.asarray(self._displacement[row]).astype(np.float32)
        return Field(occupancy, displacement)

    @contextmanager
    def _readable(self) -> Iterator[None]:
        try:
            yield
        except (OSError, zipfile.BadZipFile, KeyError, ValueError, TypeError, RuntimeError) as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            remedy = "extract the fields of this shard again"
            raise UserError(f"{self._path}: not a whole field shard ({reason}); {remedy}") from None


def _text_list(value: object) -> list[str]:
    if not isinstance(value, list):
        raise TypeError(f"ids are {value!r}")
    return [str(item) for item in value]


def _array(group: zarr.Group, name: str, shape: tuple[int | None, ...]) -> zarr.Array[Any]:
    array = group[name]
    if not isinstance(array, zarr.Array) or array.ndim != len(shape):
        raise ValueError(f"{name} is not an array of {len(shape)} dimensions")
    if any(want is not None and want != got for want, got in zip(shape, array.shape, strict=True)):
        raise ValueError(f"{name} has shape {array.shape}")
    return array


def _write_group(folder: Path, ids: list[str], fields: Iterable[Field], grid_digest: str) -> None:
    attributes = {"ids": ids, "grid_digest": grid_digest}
    group = zarr.create_group(LocalStore(folder), attributes=attributes)
    count = 0
    for field in fields:
        if count == 0:
            occupancy, displacement = _create_arrays(group, len(ids), len(field.occupancy))
        if count < len(ids):
            occupancy[count] = field.occupancy
            displacement[count] = field.displacement.astype(np.float16)
        count += 1
    if count != len(ids):
        raise ValueError(f"{count} fields for {len(ids)} ids")
    if count == 0:
        _create_arrays(group, 0, 0)


def _create_arrays(group: zarr.Group, shapes: int, tets: int) -> tuple[zarr.Array[Any], zarr.Array[Any]]:
    chunk = (1, max(tets, 1))  # Zarr wants no chunk of length 0
    occupancy = group.create_array("occupancy", shape=(shapes, tets), chunks=chunk, dtype="bool")
    displacement = group.create_array(
        "displacement", shape=(shapes, tets, 3), chunks=(*chunk, 3), dtype="float16"
    )
    return occupancy, displacement


def _pack(folder: Path, path: Path) -> None:
    """Zip a folder. Zarr's own ZipStore stamps the time on every entry, so no two runs would agree."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for source in sorted(item for item in folder.rglob("*") if item.is_file()):
            entry = zipfile.ZipInfo(source.relative_to(folder).as_posix())  # dated 1980-01-01
            entry.external_attr = 0o644 << 16
            with source.open("rb") as stream, archive.open(entry, "w") as sink:
                shutil.copyfileobj(stream, sink)
