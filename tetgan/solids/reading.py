"""Tet meshes of any program, read from files."""

import contextlib
import io
from pathlib import Path

import meshio
import numpy as np
import trimesh

from tetgan.errors import UserError
from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.triangles import TriangleMesh
from tetgan.solids import usd
from tetgan.solids.solid import SolidMesh

SUFFIXES = (".msh", ".vtu", ".vtk", ".mesh", ".inp", ".xdmf", ".npz", *usd.SUFFIXES)
"""Formats that are looked for in folders; a file named by itself may have any that meshio reads."""

_SOLID_CELLS = ("tetra", "hexahedron", "wedge", "pyramid", "polyhedron")


def read_tets(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) float64 and tets (T, 4) int64 of a file, as they are numbered there.

    Surfaces, edges and points in the file are left out.

    Raises:
        UserError: there is no such file, it cannot be read, or holds anything but finite linear tets.
    """
    if not path.is_file():
        raise UserError(f"{path}: no such file")
    if path.suffix == ".npz":
        vertices, tets = _read_arrays(path)
    elif path.suffix.lower() in usd.SUFFIXES:
        vertices, tets = usd.read_usd(path)
    else:
        vertices, tets = _read_meshio(path)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or tets.ndim != 2 or tets.shape[1] != 4:
        raise UserError(
            f"{path}: expected vertices (V, 3) and tets (T, 4), got {vertices.shape}, {tets.shape}"
        )
    if len(tets) and not 0 <= tets.min() <= tets.max() < len(vertices):
        raise UserError(f"{path}: a tet has a vertex that is not there")
    if not np.isfinite(vertices[tets]).all():
        raise UserError(f"{path}: a coordinate is not finite")
    return vertices, tets


def read_solid(path: Path) -> SolidMesh:
    """The same with the boundary, without the vertices that no tet uses.

    Raises:
        UserError: as `read_tets`; or there are no tets, or a face has more than two.
    """
    vertices, tets = read_tets(path)
    if len(tets) == 0:
        raise UserError(f"{path}: no tets")
    used, compact = np.unique(tets, return_inverse=True)
    tets = compact.reshape(-1, 4)
    try:
        return SolidMesh(vertices[used], tets, boundary_faces(tets))
    except ValueError as error:
        raise UserError(f"{path}: {error}; `tetgan certify` tells more") from None


def find_meshes(path: Path) -> list[Path]:
    """The file itself, or the files of a folder and its folders that may hold tets, in order.

    Raises:
        UserError: there is no such file or folder, or nothing in the folder.
    """
    if not path.is_dir():
        return [path]
    found = sorted(p for p in path.rglob("*") if p.suffix in SUFFIXES and not p.name.startswith("."))
    if not found:
        raise UserError(f"{path}: no tet meshes ({' '.join(SUFFIXES)}) in this folder")
    return found


def _read_arrays(path: Path) -> tuple[np.ndarray, np.ndarray]:
    try:
        with np.load(path, allow_pickle=False) as arrays:
            return arrays["vertices"].astype(np.float64), arrays["tets"].astype(np.int64)
    except Exception as error:  # a damaged archive fails in many ways
        raise UserError(f"{path}: not an archive of vertices and tets ({error})") from None


def _read_meshio(path: Path) -> tuple[np.ndarray, np.ndarray]:
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshio.read(path)
    except (Exception, SystemExit) as error:  # its parsers raise what they please, and it ends the program
        told = " ".join(f"{error if isinstance(error, Exception) else ''} {said.getvalue()}".split())
        raise UserError(f"{path}: cannot be read as a mesh ({told or type(error).__name__})") from None
    other = {block.type for block in mesh.cells if block.type.startswith(_SOLID_CELLS)} - {"tetra"}
    if other:
        raise UserError(f"{path}: holds {', '.join(sorted(other))} cells; only linear tets can be used")
    blocks = [block.data for block in mesh.cells if block.type == "tetra"]
    if not blocks:
        raise UserError(f"{path}: no tets in it")
    return np.asarray(mesh.points, dtype=np.float64), np.concatenate(blocks).astype(np.int64)


def read_surface(path: Path) -> TriangleMesh | None:
    """The triangles of a file, exactly as stored; None when there is no file, no face, or no area.

    A generated shape may be empty: that is a result to count, not an error.

    Raises:
        UserError: the file is damaged.
    """
    if not path.is_file():
        return None
    try:
        mesh = trimesh.load_mesh(path, process=False)
    except Exception as error:  # its parsers raise what they please
        raise UserError(f"{path}: cannot be read as a mesh ({error}); remove it, or make it again") from None
    faces = np.asarray(mesh.faces)
    if not len(faces) or not mesh.area > 0:
        return None
    return TriangleMesh(np.asarray(mesh.vertices, dtype=np.float64), faces.astype(np.int64))
