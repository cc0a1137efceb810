"""List the shapes of any source, and load one."""

import hashlib
from collections.abc import Callable, Iterable
from pathlib import PurePosixPath
from typing import Any

import numpy as np

from tetgan.errors import UserError
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes import collections, sweethome3d
from tetgan.shapes.builtin.generate import CATEGORIES, generate_shape
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.entries import ShapeEntry, draw_entries, name_entries
from tetgan.shapes.loading import parse_mesh, read_file
from tetgan.shapes.options import BuiltinSource, FolderSource, SourceOptions, SweetHome3DSource

_LISTERS: dict[str, Callable[[Any, str], Iterable[tuple[str, str, str | None]]]] = {
    "directory": collections.list_directory,
    "shapenet": collections.list_shapenet,
    "coseg": collections.list_coseg,
    "modelnet": collections.list_modelnet,
    "sweethome3d": sweethome3d.list_sweethome3d,
}

_Z_UP_TO_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


def list_shapes(source: SourceOptions, category: str) -> list[ShapeEntry]:
    """Every shape of a category, sorted by id; the same list on every call.

    Raises:
        UserError: the root does not exist, or holds no shape of the category.
    """
    if isinstance(source, BuiltinSource):
        return _list_builtin(source, category)
    if not source.path.is_dir():
        raise UserError(f"sources.{category}.path: no folder {source.path}")
    entries = name_entries(_LISTERS[source.kind](source, category))
    if not entries:
        raise UserError(f"sources.{category}: no {source.kind} mesh for '{category}' below {source.path}")
    return draw_entries(entries, source.limit)


def load_shape(source: SourceOptions, category: str, entry: ShapeEntry) -> TriangleMesh:
    """Triangles of an entry, y up, otherwise as they come.

    Raises:
        ShapeError: the file cannot be read or has no triangle.
    """
    if isinstance(source, BuiltinSource):
        shape = generate_shape(category, int(entry.path), source.seed)
        return shape
    soup = parse_mesh(_read(source, entry), PurePosixPath(entry.path).suffix.lower())
    vertices = soup.vertices
    if isinstance(source, SweetHome3DSource):
        vertices = vertices @ sweethome3d.model_rotation(source, entry.path).T
    if source.up == "z":
        vertices = vertices @ _Z_UP_TO_Y_UP.T
    return TriangleMesh(vertices, soup.faces)


def digest_shape(source: SourceOptions, category: str, entry: ShapeEntry) -> str:
    """SHA-256 in hex of an entry's file, or of a generated shape's arrays; empty if it cannot be read."""
    try:
        if not isinstance(source, BuiltinSource):
            return hashlib.sha256(_read(source, entry)).hexdigest()
        soup = load_shape(source, category, entry)
    except ShapeError:
        return ""
    arrays = (soup.vertices.astype("<f8"), soup.faces.astype("<i8"))
    return hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()


def _list_builtin(source: BuiltinSource, category: str) -> list[ShapeEntry]:
    if category not in CATEGORIES:
        raise UserError(f"sources.{category}: no built-in shapes; there are {', '.join(CATEGORIES)}")
    return [
        ShapeEntry(f"{category}-{index:05d}", str(index), None if index < source.count else "holdout")
        for index in range(source.count + source.holdout)
    ]


def _read(source: FolderSource, entry: ShapeEntry) -> bytes:
    if isinstance(source, SweetHome3DSource):
        return sweethome3d.read_model(source, entry.path)
    return read_file(source.path / entry.path)
