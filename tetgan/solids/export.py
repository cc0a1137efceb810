"""Write meshes in the formats of other programs."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import trimesh

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.geometry.triangles import TriangleMesh
from tetgan.solids.solid import SolidMesh

SURFACES = (".ply", ".obj", ".stl", ".off", ".glb")
"""Formats of `write_surface`."""

SOLIDS = (".msh", ".vtu", ".vtk", ".mesh", ".inp", ".xdmf", ".npz")
"""Formats of `write_tets` that are tested with other programs; it writes what else meshio does."""

MSH_VERSIONS = {"2.2": "gmsh22", "4.1": "gmsh"}
"""Of Gmsh's format, and what meshio calls them."""


def write_mesh(path: str | Path, mesh: SolidMesh, *, msh_version: str = "2.2") -> None:
    """Write the solid, or its boundary where the suffix is that of a surface.

    Raises:
        UserError: no format has that suffix, or there is no such version.
    """
    if Path(path).suffix.lower() in SURFACES:
        write_surface(path, mesh)
    else:
        write_tets(path, mesh, msh_version=msh_version)


def write_surface(path: str | Path, mesh: SolidMesh | TriangleMesh) -> None:
    """Write a surface, or the boundary of a solid, as triangles.

    The format is that of the suffix: `.ply`, `.obj`, `.stl`, `.off`, `.glb`; the
    coordinates of `.ply`, `.stl` and `.glb` have single precision.

    Raises:
        UserError: trimesh cannot write that suffix.
    """
    used, compact = np.unique(mesh.faces, return_inverse=True)
    surface = trimesh.Trimesh(mesh.vertices[used], compact.reshape(-1, 3), process=False)
    with whole_file(path) as partial:
        try:
            surface.export(partial)
        except ValueError:
            raise _unknown_format(path, "'.ply', '.obj' or '.stl'") from None


def write_tets(path: str | Path, mesh: SolidMesh, *, msh_version: str = "2.2") -> None:
    """Write the solid, in the format of the suffix: one of `SOLIDS`, or another that meshio writes.

    `.npz` holds `vertices`, `tets` and `faces` as they are in memory.

    Args:
        msh_version: of Gmsh's format; most solvers read 2.2.

    Raises:
        UserError: meshio cannot write that suffix, or there is no such version.
    """
    if msh_version not in MSH_VERSIONS:
        raise UserError(f"{path}: no version '{msh_version}' of Gmsh's format; use 2.2 or 4.1")
    with whole_file(path) as partial:
        if Path(path).suffix == ".npz":
            np.savez_compressed(partial, vertices=mesh.vertices, tets=mesh.tets, faces=mesh.faces)
            return
        cells, how = _for_meshio(Path(path).suffix, mesh, msh_version)
        try:
            meshio.write(partial, cells, **how)
        except (meshio.ReadError, meshio.WriteError):
            raise _unknown_format(path, "'.msh' or '.vtu'") from None


def _for_meshio(suffix: str, mesh: SolidMesh, msh_version: str) -> tuple[meshio.Mesh, dict[str, Any]]:
    """What to write, and how."""
    cells = meshio.Mesh(mesh.vertices, [("tetra", mesh.tets)])
    if suffix == ".xdmf":
        return cells, {"data_format": "XML"}  # one file; by default the arrays go to a second one, in HDF5
    if suffix != ".msh":
        return cells, {}
    # By default meshio writes Ansys files under this suffix. Gmsh wants a group for each tet.
    group = [np.ones(len(mesh.tets), dtype=np.int32)]
    cells.cell_data = {"gmsh:physical": group, "gmsh:geometrical": group}
    if msh_version == "4.1":  # here every vertex belongs to an entity as well: the one volume
        one = np.array([3, 1], dtype=np.int32)
        cells.point_data = {"gmsh:dim_tags": np.tile(one, (len(mesh.vertices), 1))}
    return cells, {"file_format": MSH_VERSIONS[msh_version]}


def _unknown_format(path: str | Path, remedy: str) -> UserError:
    return UserError(f"{path}: no mesh format '{Path(path).suffix}' to write; use {remedy}")
