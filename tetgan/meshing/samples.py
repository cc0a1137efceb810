"""Decoded shapes to a folder of meshes and the rows of their certificate."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from tetgan.fields.field import Field, VertexField, vertex_operator
from tetgan.geometry.triangles import TriangleMesh
from tetgan.grids.grid import TetGrid
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.solids.certificate import certify
from tetgan.solids.certify import write_certificate
from tetgan.solids.export import write_surface, write_tets
from tetgan.solids.record import quality_record, surface_record


def write_solids(
    folder: Path,
    fields: Iterable[tuple[str, Field | VertexField, Mapping[str, Any]]],
    grid: TetGrid,
    mu: float,
    options: MeshingOptions,
    *,
    smoothing: bool,
) -> list[dict[str, Any]]:
    """Write `{id}.ply`, `{id}.vtu` and its certificate, `{id}.json`, for each field.

    Args:
        folder: made if it does not exist.
        fields: id, field in cube sides, and further columns for its row.
        grid: the finest grid of the hierarchy.

    Returns:
        A row for each field: `id`, the further columns, then `quality_record`. A field with nothing in it
        gets a row of zeros and no files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    operator = vertex_operator(grid)
    rows = []
    for shape_id, field, columns in fields:
        mesh = build_solid(field, grid, operator, mu, options, smoothing=smoothing)
        certificate = certify(mesh.vertices, mesh.tets)
        if len(mesh.tets):
            write_surface(folder / f"{shape_id}.ply", mesh)
            write_tets(folder / f"{shape_id}.vtu", mesh)
            write_certificate(folder / f"{shape_id}.json", certificate)
        rows.append({"id": shape_id, **columns, **quality_record(mesh, certificate)})
    return rows


def write_surfaces(
    folder: Path, surfaces: Iterable[tuple[str, TriangleMesh, Mapping[str, Any]]]
) -> list[dict[str, Any]]:
    """Write `{id}.ply` for each surface.

    Args:
        folder: made if it does not exist.
        surfaces: id, surface, and further columns for its row.

    Returns:
        A row for each surface: `id`, the further columns, then `surface_record`. One without faces gets a row
        of zeros and no file.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for shape_id, surface, columns in surfaces:
        if len(surface.faces):
            write_surface(folder / f"{shape_id}.ply", surface)
        rows.append({"id": shape_id, **columns, **surface_record(surface)})
    return rows
