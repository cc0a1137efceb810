"""Mesh files to triangle soups; bytes are untrusted: no pickle, no second file, bounded size."""

import io
import logging
import re
import zipfile
from pathlib import Path

import numpy as np

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import ShapeError

MESH_SUFFIXES = frozenset({".obj", ".off", ".ply", ".stl", ".glb"})

LARGEST_FILE = 512 * 2**20


def read_file(path: Path) -> bytes:
    """Content of a mesh file.

    Raises:
        ShapeError: it cannot be read or is larger than `LARGEST_FILE` bytes.
    """
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise ShapeError("file too large")
        return path.read_bytes()
    except OSError as error:
        raise ShapeError(f"unreadable file: {error.strerror}") from None


def read_zip_member(path: Path, member: str) -> bytes:
    """Content of one file in a zip; nothing is unpacked to disk, so a member's name cannot lead anywhere.

    Raises:
        ShapeError: no such member, a damaged one, or one that unpacks to more than `LARGEST_FILE` bytes.
    """
    try:
        with zipfile.ZipFile(path) as archive, archive.open(member) as stream:
            data = stream.read(LARGEST_FILE + 1)
    except (OSError, KeyError, RuntimeError, zipfile.BadZipFile, NotImplementedError) as error:
        raise ShapeError(f"unreadable zip member: {type(error).__name__}") from None
    if len(data) > LARGEST_FILE:
        raise ShapeError("file too large")
    return data


def parse_mesh(data: bytes, suffix: str) -> TriangleMesh:
    """Triangles of a mesh file; the parts of a scene are placed and joined, polygons triangulated.

    Reading from memory, trimesh has no folder to resolve a material, texture or buffer from.

    Raises:
        ShapeError: the parser fails or finds no triangle.
    """
    import trimesh  # noqa: PLC0415  half a second, wanted only where meshes are read

    if suffix == ".off":
        data = _split_off_header(data)
    # An untrusted file can make the parser raise anything at all, and whatever it is costs this shape only.
    try:
        scene = trimesh.load_scene(io.BytesIO(data), file_type=suffix[1:], process=False, skip_materials=True)
        mesh = scene.to_mesh()
        vertices, faces = np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64)
    except Exception as error:
        logging.getLogger(__name__).debug("parser failed", exc_info=True)
        raise ShapeError(f"unreadable mesh: {type(error).__name__}") from None
    if not len(faces):
        raise ShapeError("no faces")
    return TriangleMesh(vertices.reshape(-1, 3), faces.reshape(-1, 3))


def _split_off_header(data: bytes) -> bytes:
    """ModelNet has files that begin 'OFF490 518 0': the line break after the magic word is missing."""
    return re.sub(rb"\A\s*(C?OFF)(?=\d)", rb"\1\n", data, count=1)
