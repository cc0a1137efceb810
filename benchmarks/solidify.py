"""Solids of any surface, ours and fTetWild's, with edges of one length: validity, angles, accuracy, time.

    python benchmarks/solidify.py --meshes FOLDER --count 40 --builtin 20 --out solids.csv

fTetWild (Hu et al. 2020) comes with `pip install tetgan[remesh]`; without it there are only our rows. Its
Python package has no option for a manifold boundary. Both get the same closed surface.
"""

import random
import resource
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from time import process_time
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from rich.console import Console
from rich.progress import track

from tetgan.geometry.adjacency import boundary_faces
from tetgan.geometry.tets import TetMesh, dihedral_angles
from tetgan.geometry.triangles import TriangleMesh
from tetgan.mechanics.options import RemeshOptions
from tetgan.mechanics.remesh import RemeshWorker, can_remesh
from tetgan.meshing.solidify import SolidifyOptions, make_solid, surface_distance
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.closing import close_surface
from tetgan.shapes.entries import ShapeEntry
from tetgan.shapes.loading import MESH_SUFFIXES, parse_mesh
from tetgan.shapes.options import BuiltinSource, RepairOptions
from tetgan.shapes.sources import load_shape
from tetgan.solids.certificate import certify

CATEGORIES = ("chair", "table", "sofa", "bench", "car", "vase")

SMALL = 15.0  # degrees: shares of tets with a smaller dihedral angle are counted

TIMEOUT = 300.0  # processor seconds for fTetWild


def main(
    *,
    meshes: Annotated[Path | None, typer.Option(help="Folder of meshes, nested or not.")] = None,
    count: Annotated[int, typer.Option(help="Of them, drawn by a seed.")] = 40,
    builtin: Annotated[int, typer.Option(help="Built-in shapes, of all categories in turn.")] = 20,
    cells: Annotated[int, typer.Option(help="Cells along the longest side.")] = 32,
    compared: Annotated[int, typer.Option(help="Shapes of each group that fTetWild gets too.")] = 1000,
    out: Annotated[Path | None, typer.Option(help="Write a row for each shape and mesher (.csv).")] = None,
) -> None:
    """Compare; seconds are processor time of one core, without the repair, certificate and distances."""
    rows: list[dict[str, Any]] = []
    jobs = [("files", *job) for job in _from_folder(meshes, count)] if meshes else []
    jobs = _in_turns(jobs, [("built-in", *job) for job in _builtin(builtin)])
    done = {"files": 0, "built-in": 0}
    for group, name, soup in track(jobs, "solidify", console=Console(stderr=True)):
        rows += [
            {"group": group, "shape": name, **row} for row in measure(soup, cells, done[group] < compared)
        ]
        done[group] += 1
        if out is not None:
            pd.DataFrame(rows).to_csv(out, index=False)
    typer.echo(summary(pd.DataFrame(rows)).to_markdown())


def measure(load: Callable[[], TriangleMesh], cells: int, compared: bool) -> list[dict[str, Any]]:
    """A row for each mesher."""
    try:
        surface, repair, _ = close_surface(load(), "auto", RepairOptions())
        start = process_time()
        solid, edge = make_solid(surface, SolidifyOptions(cells=cells))
        rows = [{"mesher": "tetgan", "seconds": process_time() - start, **_row(solid, surface)}]
    except ShapeError as error:
        return [{"mesher": "tetgan", "problem": str(error)}]
    if compared and can_remesh():
        rows.append({"mesher": "fTetWild", **_tetwild(surface, edge)})
    return [{"repair": repair, **row} for row in rows]


def summary(rows: pd.DataFrame) -> pd.DataFrame:
    """A row for each group and mesher, over the shapes that both have meshed, and over all."""
    both = rows.groupby("shape")["tets"].transform("count") == 2
    parts = {"all": rows, "both": rows[both]}
    found = {}
    for which, part in parts.items():
        for key, some in part.groupby(["group", "mesher"]):
            made = some.dropna(subset="tets")
            found[(which, *key)] = {
                "shapes": len(some),
                "meshed": len(made),
                "valid": int(made["valid"].sum()),
                "least angle": made["min_dihedral"].min(),
                "below 15 degrees, mean share": made["small"].mean(),
                "volume error, median": made["volume_error"].median(),
                "distance / side, median": made["mean"].median(),
                "Hausdorff / side, median": made["hausdorff"].median(),
                "least Jacobian, VTK": made["vtk_jacobian"].min() if "vtk_jacobian" in made else np.nan,
                "wrong edges, VTK": made["vtk_edges"].sum() if "vtk_edges" in made else np.nan,
                "tets, median": made["tets"].median(),
                "seconds, median": made["seconds"].median(),
                "seconds, most": made["seconds"].max(),
            }
    return pd.DataFrame(found).T


def _tetwild(surface: TriangleMesh, edge: float) -> dict[str, Any]:
    """The row of fTetWild; its seconds include the start of its process, some tenths."""
    diagonal = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    options = RemeshOptions(edge=edge / diagonal, timeout_seconds=TIMEOUT)
    with RemeshWorker(options) as worker:
        start = _children_seconds()
        try:
            mesh = worker.remesh_surface(surface)
        except ShapeError as error:
            return {"problem": str(error)}
        finally:
            worker.close()
        return {"seconds": _children_seconds() - start, **_row(mesh, surface)}


def _children_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _row(mesh: TetMesh, surface: TriangleMesh) -> dict[str, Any]:
    found = certify(mesh.vertices, mesh.tets)
    angles = dihedral_angles(mesh.vertices, mesh.tets).min(axis=1)
    side = np.ptp(surface.vertices, axis=0).max()
    boundary = TriangleMesh(mesh.vertices, boundary_faces(mesh.tets))
    largest, mean = surface_distance(surface, boundary)
    return {
        "tets": found.tets,
        "valid": found.valid,
        "reasons": "; ".join(found.reasons),
        "min_dihedral": found.min_dihedral,
        "small": float((angles < SMALL - 1e-6).mean()),
        "volume_error": abs(found.volume / surface.volume - 1),
        "hausdorff": largest / side,
        "mean": mean / side,
        **(_by_vtk(mesh) if find_spec("vtk") else {}),
    }


def _by_vtk(mesh: TetMesh) -> dict[str, Any]:
    """By VTK: least scaled Jacobian of a tet, and edges of the boundary without two faces."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: PLC0415
    from vtkmodules.vtkCommonCore import vtkPoints  # noqa: PLC0415
    from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkCellArray, vtkUnstructuredGrid  # noqa: PLC0415
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges  # noqa: PLC0415
    from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter  # noqa: PLC0415
    from vtkmodules.vtkFiltersVerdict import vtkMeshQuality  # noqa: PLC0415

    points, cells, grid = vtkPoints(), vtkCellArray(), vtkUnstructuredGrid()
    points.SetData(numpy_to_vtk(mesh.vertices, deep=True))
    offsets = np.arange(0, 4 * len(mesh.tets) + 1, 4, dtype=np.int64)
    cells.SetData(numpy_to_vtk(offsets, deep=True), numpy_to_vtk(mesh.tets.ravel(), deep=True))
    grid.SetPoints(points)
    grid.SetCells(VTK_TETRA, cells)
    quality, surface, edges = vtkMeshQuality(), vtkGeometryFilter(), vtkFeatureEdges()
    quality.SetInputData(grid)
    quality.SetTetQualityMeasureToScaledJacobian()
    quality.Update()
    surface.SetInputData(grid)
    edges.SetInputConnection(surface.GetOutputPort())
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    jacobians = vtk_to_numpy(quality.GetOutput().GetCellData().GetArray("Quality"))
    return {"vtk_jacobian": float(jacobians.min()), "vtk_edges": edges.GetOutput().GetNumberOfCells()}


def _from_folder(folder: Path, count: int) -> Iterator[tuple[str, Callable[[], TriangleMesh]]]:
    paths = sorted(path for path in folder.rglob("*") if path.suffix.lower() in MESH_SUFFIXES)
    random.Random(0).shuffle(paths)
    for path in paths[:count]:
        yield (
            path.relative_to(folder).as_posix(),
            lambda path=path: parse_mesh(path.read_bytes(), path.suffix.lower()),
        )


def _builtin(count: int) -> Iterator[tuple[str, Callable[[], TriangleMesh]]]:
    source = BuiltinSource(kind="builtin")
    for number in range(count):
        category, place = CATEGORIES[number % len(CATEGORIES)], number // len(CATEGORIES)
        entry = ShapeEntry(f"{category}-{place}", str(place))
        yield entry.id, lambda category=category, entry=entry: load_shape(source, category, entry)


def _in_turns(one: list[Any], other: list[Any]) -> list[Any]:
    """Both lists shuffled together, so that a run cut short has seen both."""
    joined = [*one, *other]
    random.Random(1).shuffle(joined)
    return joined


if __name__ == "__main__":
    typer.run(main)
