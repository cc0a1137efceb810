"""Meshes in the formats that other programs read."""

from pathlib import Path

import meshio
import numpy as np
import trimesh

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.meshing.solid import SolidMesh
from tetgan.shapes.soup import Soup


def write_surface(path: str | Path, mesh: SolidMesh | Soup) -> None:
    """Write a surface, or the boundary of a solid, as triangles.

    The format is that of the suffix: `.ply`, `.obj`, `.stl`, `.off`, `.glb`; the
    coordinates of `.ply` and `.stl` have single precision.

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


def write_tets(path: str | Path, mesh: SolidMesh) -> None:
    """Write the solid, in the format of the suffix: `.msh` (Gmsh 2.2), `.vtu`, `.vtk`, `.mesh`, `.inp`, ….

    Raises:
        UserError: meshio cannot write that suffix.
    """
    cells = meshio.Mesh(mesh.vertices, [("tetra", mesh.tets)])
    file_format = None
    if Path(path).suffix == ".msh":
        # By default meshio writes Ansys files under this suffix. Gmsh's 2.2 is what most solvers read; it
        # wants a group for each tet.
        file_format = "gmsh22"
        group = [np.ones(len(mesh.tets), dtype=np.int32)]
        cells.cell_data = {"gmsh:physical": group, "gmsh:geometrical": group}
    with whole_file(path) as partial:
        try:
            meshio.write(partial, cells, file_format=file_format)
        except (meshio.ReadError, meshio.WriteError):
            raise _unknown_format(path, "'.msh' or '.vtu'") from None


def _unknown_format(path: str | Path, remedy: str) -> UserError:
    return UserError(f"{path}: no mesh format '{Path(path).suffix}' to write; use {remedy}")
