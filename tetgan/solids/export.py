"""Write meshes in the formats of other programs."""

from pathlib import Path

import meshio
import numpy as np
import trimesh
from jaxtyping import Int

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.geometry.triangles import TriangleMesh
from tetgan.solids import usd
from tetgan.solids.abaqus import Section, write_inp
from tetgan.solids.elements import Elements, linear_elements
from tetgan.solids.msh import VERSIONS, write_msh
from tetgan.solids.solid import SolidMesh
from tetgan.solids.units import UNITS, UnitSystem

SURFACES = (".ply", ".obj", ".stl", ".off", ".glb")
"""Formats of `write_surface`."""

SOLIDS = (".msh", ".vtu", ".vtk", ".mesh", ".inp", ".xdmf", ".npz", *usd.SUFFIXES)
"""Formats of `write_tets` that are tested with other programs; it writes what else meshio does."""

QUADRATIC = (".msh", ".vtu", ".vtk", ".inp", ".xdmf")
"""Those that hold elements of degree 2; the same hold groups."""


def write_mesh(
    path: str | Path,
    mesh: SolidMesh | Elements,
    *,
    msh_version: str = "2.2",
    system: UnitSystem = UNITS["m"],
    section: Section | None = None,
) -> None:
    """Write the solid, or its boundary where the suffix is that of a surface; see `write_tets`.

    Raises:
        UserError: no format has that suffix, or there is no such version.
    """
    if Path(path).suffix.lower() in SURFACES:
        surface = mesh if isinstance(mesh, SolidMesh) else TriangleMesh(mesh.nodes, mesh.faces[:, :3])
        write_surface(path, surface)
    else:
        write_tets(path, mesh, msh_version=msh_version, system=system, section=section)


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


def write_tets(
    path: str | Path,
    mesh: SolidMesh | Elements,
    *,
    msh_version: str = "2.2",
    system: UnitSystem = UNITS["m"],
    section: Section | None = None,
) -> None:
    """Write the solid, in the format of the suffix: one of `SOLIDS`, or another that meshio writes.

    `.npz` holds `vertices`, `tets` and `faces`. Groups are sets in `.inp`, physical groups in `.msh`, and 0
    or 1 at the nodes and elements of `.vtu`, `.vtk` and `.xdmf`; other formats have none.

    Args:
        msh_version: of Gmsh's format; most solvers read 2.2.
        system: units of the coordinates, told in `.inp` and USD.
        section: material of the whole solid, for `.inp`.

    Raises:
        UserError: meshio cannot write that suffix, it has no elements of that degree, there is no such
            version, or usd-core is not installed.
    """
    suffix = Path(path).suffix.lower()
    elements = mesh if isinstance(mesh, Elements) else linear_elements(mesh)
    if msh_version not in VERSIONS:
        raise UserError(f"{path}: no version '{msh_version}' of Gmsh's format; use 2.2 or 4.1")
    if elements.order == 2 and suffix not in QUADRATIC:
        raise UserError(
            f"{path}: '{suffix}' has no elements of degree 2; use {' '.join(QUADRATIC)}, or --order 1"
        )
    if suffix in usd.SUFFIXES:
        usd.load_pxr(path)  # before the file has its temporary name, which an error would tell
    with whole_file(path) as partial:
        if suffix == ".npz":
            np.savez_compressed(partial, vertices=elements.nodes, tets=elements.tets, faces=elements.faces)
        elif suffix == ".inp":
            write_inp(partial, elements, system, section)
        elif suffix == ".msh":
            write_msh(partial, elements, msh_version)
        elif suffix in usd.SUFFIXES:
            usd.write_usd(partial, elements, system.length)
        else:
            _write_meshio(path, partial, elements)


def _write_meshio(path: str | Path, partial: Path, elements: Elements) -> None:
    suffix = Path(path).suffix.lower()
    cells = meshio.Mesh(elements.nodes, [("tetra" if elements.order == 1 else "tetra10", elements.cells)])
    if suffix in QUADRATIC:
        for name in elements.groups:
            cells.point_data[name] = _flags(elements.nodes_of(name), len(elements.nodes))
            cells.cell_data[name] = [_flags(elements.cells_of(name), len(elements.cells))]
    # One file; by default the arrays go to a second one, in HDF5.
    how = {"data_format": "XML"} if suffix == ".xdmf" else {}
    try:
        meshio.write(partial, cells, **how)
    except (meshio.ReadError, meshio.WriteError):
        raise _unknown_format(path, "'.msh' or '.vtu'") from None


def _flags(members: Int[np.ndarray, "M"], count: int) -> Int[np.ndarray, "N"]:
    """1 for members, 0 for the others."""
    flags = np.zeros(count, dtype=np.int32)  # meshio knows no shorter one in .xdmf
    flags[members] = 1
    return flags


def _unknown_format(path: str | Path, remedy: str) -> UserError:
    return UserError(f"{path}: no mesh format '{Path(path).suffix}' to write; use {remedy}")
