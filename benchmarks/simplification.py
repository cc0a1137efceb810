"""Time that simplifying repaired meshes saves, and the error it adds to their fields.

python benchmarks/simplification.py --shapes 8
python benchmarks/simplification.py --source '{"kind": "directory", "path": "my/chairs"}'
"""

import json
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from pydantic import TypeAdapter
from records import Records, cpu_seconds, record
from rich.console import Console
from rich.progress import track

from tetgan.fields.extraction import extract_field
from tetgan.fields.field import Field, surface_tets
from tetgan.geometry.triangles import TriangleMesh
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.entries import draw_entries
from tetgan.shapes.isolation import RepairWorker
from tetgan.shapes.normalise import normalise
from tetgan.shapes.options import RepairOptions, SourceOptions
from tetgan.shapes.repair import repair_shape, simplify_solid
from tetgan.shapes.sources import list_shapes, load_shape

_MARGIN = 0.02
_FACES = (20_000, 5_000, 1_500)


def run(quick: bool) -> Records:
    """Time with and without, and the error added on LR, for chairs repaired as in the paper."""
    table = summarise(compare('{"kind": "builtin"}', "chair", 1 if quick else 6, cells=2, depth=3))
    found: Records = {"field, LR, as repaired by octree": record(table.loc["all", "field_seconds"], "CPU-s")}
    for faces, row in table.drop("all").iterrows():
        name = f"simplified to {faces} faces"
        found[f"field, LR, {name}"] = record(row["field_seconds"] + row["simplify_seconds"], "CPU-s")
        found[f"{name}: mean error of a distance"] = record(row["distance_error"], "cube sides")
        found[f"{name}: occupancies changed"] = record(row["occupancy_changed"], "of occupied tets")
    return found


def main(
    *,
    source: Annotated[str, typer.Option(help="source as in the config, JSON")] = '{"kind": "builtin"}',
    category: Annotated[str, typer.Option(help="category of the source")] = "chair",
    shapes: Annotated[int, typer.Option(min=1, help="shapes to draw")] = 8,
    method: Annotated[str, typer.Option(help="repair: manifold (as the paper) or alpha_wrap")] = "manifold",
    cells: Annotated[int, typer.Option(help="cells along each side of the cube: 2 for LR, 3 for HR")] = 2,
    depth: Annotated[int, typer.Option(help="subdivisions: 3 for the paper's grids")] = 3,
) -> None:
    """Print the table of docs/performance.md: means over the shapes; lengths are in cube sides."""
    rows = compare(source, category, shapes, cells=cells, depth=depth, method=method)
    typer.echo(summarise(rows).to_markdown(floatfmt=".3g"))


def compare(
    source: str, category: str, shapes: int, *, cells: int, depth: int, method: str = "manifold"
) -> pd.DataFrame:
    """One row a shape and number of faces."""
    grid = build_hierarchy(cells, depth).finest
    _ = grid.centroids, grid.neighbors
    solids = _repaired(
        TypeAdapter(SourceOptions).validate_python(json.loads(source)), category, shapes, method
    )
    return pd.DataFrame([row for solid in solids for row in _compare_shape(solid, grid)])


def _repaired(source: SourceOptions, category: str, count: int, method: str) -> list[TriangleMesh]:
    options = RepairOptions.model_validate({"method": method})
    entries = [entry for entry in list_shapes(source, category) if entry.split != "holdout"]
    solids = []
    with RepairWorker(options) as worker:
        for entry in track(draw_entries(entries, count), "repair", console=Console(stderr=True)):
            try:
                solid = repair_shape(load_shape(source, category, entry), worker, options).solid
            except ShapeError:
                continue  # a shape that the pipeline rejects, too
            solids.append(TriangleMesh(normalise(solid.vertices, _MARGIN), solid.faces))
    return solids


def _compare_shape(solid: TriangleMesh, grid: TetGrid) -> list[dict[str, Any]]:
    seconds, truth = cpu_seconds(lambda: extract_field(solid.vertices, solid.faces, grid))
    rows: list[dict[str, Any]] = [{"to": "all", "faces": len(solid.faces), "field_seconds": seconds}]
    for faces in _FACES:
        spent, simplified = cpu_seconds(lambda faces=faces: simplify_solid(solid, faces))
        seconds, field = cpu_seconds(lambda soup=simplified: extract_field(soup.vertices, soup.faces, grid))
        row = {"to": f"{faces:,}", "faces": len(simplified.faces)}
        row |= {"simplify_seconds": spent, "field_seconds": seconds}
        rows.append(row | added_error(field, truth, grid))
    return rows


def added_error(field: Field, truth: Field, grid: TetGrid) -> dict[str, float]:
    """How far a field is from the true one.

    Returns:
        `distance_error`, mean difference of the distances to the surface; `surface_error`, mean length of
        the difference of displacements in tets at the surface, and `surface_error_95` its 95th percentile;
        `occupancy_changed`, tets whose occupancy differs, over occupied ones.
    """
    lengths = [np.linalg.norm(each.displacement, axis=1) for each in (field, truth)]
    here = surface_tets(truth.occupancy, grid.neighbors)
    moved = np.linalg.norm((field.displacement - truth.displacement)[here], axis=1)
    return {
        "distance_error": float(np.abs(lengths[0] - lengths[1]).mean()),
        "surface_error": float(moved.mean()),
        "surface_error_95": float(np.quantile(moved, 0.95)),
        "occupancy_changed": float((field.occupancy != truth.occupancy).sum() / truth.occupancy.sum()),
    }


def summarise(rows: pd.DataFrame) -> pd.DataFrame:
    """Means over the shapes, one row per number of faces."""
    return rows.groupby("to", sort=False).mean()


if __name__ == "__main__":
    typer.run(main)
