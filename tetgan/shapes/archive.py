"""Shards of repaired meshes: one zip with two arrays per mesh and a table of records."""

import io
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.geometry.triangles import TriangleMesh

_RECORDS = "records.csv"

_TEXTS = ("id", "path", "sha256", "split", "status", "reason")

_NUMBERS = ("faces_in", "faces_out", "volume", "cube_volume", "distance", "filled_share", "seconds")

_COLUMNS: dict[str, Any] = dict.fromkeys(_TEXTS, str) | dict.fromkeys(_NUMBERS, float)


def write_meshes(
    path: Path,
    items: Iterable[tuple[str, np.ndarray, np.ndarray]],
    records: Sequence[Mapping[str, Any]],
) -> None:
    """Write (id, vertices (V, 3), faces (F, 3)) as they come, then the records.

    `records` is read after the last item, so it may be filled while the items are made. The file appears
    only when it is whole, and the same content gives the same bytes.
    """
    with whole_file(path) as partial, zipfile.ZipFile(partial, "w") as archive:
        for shape_id, vertices, faces in items:
            _add(archive, f"{shape_id}/vertices.npy", _array_bytes(vertices.astype(np.float64)))
            _add(archive, f"{shape_id}/faces.npy", _array_bytes(faces.astype(np.int32)))
        _add(
            archive,
            _RECORDS,
            pd.DataFrame(list(records), columns=list(_COLUMNS)).to_csv(index=False).encode(),
        )


def read_meshes(path: Path) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """(id, vertices (V, 3) float64, faces (F, 3) int64) of every mesh, in the order written.

    Raises:
        UserError: not a shard of meshes.
    """
    with _open(path) as archive:
        for name in archive.namelist():
            shape_id, _, part = name.rpartition("/")
            if part == "vertices.npy":
                vertices = _read_array(archive, name)
                yield shape_id, vertices, _read_array(archive, f"{shape_id}/faces.npy").astype(np.int64)


def read_mesh(path: Path, shape_id: str) -> TriangleMesh:
    """One mesh of a shard.

    Raises:
        KeyError: the shard has no such mesh.
    """
    with _open(path) as archive:
        vertices = _read_array(archive, f"{shape_id}/vertices.npy")
        return TriangleMesh(vertices, _read_array(archive, f"{shape_id}/faces.npy").astype(np.int64))


def pick_meshes(paths: Sequence[Path], ids: Iterable[str]) -> dict[str, TriangleMesh]:
    """Some meshes of several shards, by id; an id that none of them holds is left out."""
    wanted = set(ids)
    found: dict[str, TriangleMesh] = {}
    for path in paths:
        with _open(path) as archive:
            held = {name.rpartition("/")[0] for name in archive.namelist()}
        found |= {shape_id: read_mesh(path, shape_id) for shape_id in sorted(wanted & held)}
    return found


def read_records(path: Path) -> pd.DataFrame:
    """One row per listed shape of the shard, repaired or not, with columns as `read_table` gives them."""
    with _open(path) as archive:
        return read_table(io.BytesIO(archive.read(_RECORDS)))


def read_table(table: Path | io.BytesIO) -> pd.DataFrame:
    """Records from CSV: text columns are text, empty where there is nothing; numbers are NaN there.

    An id such as '0012' or 'nan' is text, whatever it looks like.
    """
    return pd.read_csv(
        table, dtype=_COLUMNS, keep_default_na=False, na_values={name: [""] for name in _NUMBERS}
    )


def _open(path: Path) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(path)
    except (OSError, zipfile.BadZipFile) as error:
        raise UserError(f"{path}: not a shard of meshes ({error})") from None


def _add(archive: zipfile.ZipFile, name: str, data: bytes) -> None:
    # A bare ZipInfo is dated 1980, which keeps the bytes of equal shards equal.
    archive.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED, compresslevel=1)


def _array_bytes(array: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    return buffer.getvalue()


def _read_array(archive: zipfile.ZipFile, name: str) -> np.ndarray:
    return np.load(io.BytesIO(archive.read(name)), allow_pickle=False)
