"""What a shape costs: its field, its place in the store and its mesh, beside brute force."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import Annotated, Any

import numpy as np
import trimesh
import typer

from tetgan.fields.extract import extract_field
from tetgan.fields.field import Field, surface_tets
from tetgan.fields.shard import ShardReader, write_shard
from tetgan.fields.vertices import vertex_operator
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.records import quality_record

_SAMPLE = 200  # tets on which brute force is tried, to be scaled up to all


def main(
    cells: Annotated[int, typer.Option(help="cells along each side of the cube: 2 for LR, 3 for HR")] = 2,
    depth: Annotated[int, typer.Option(help="subdivisions: 3 for the paper's grids")] = 3,
    faces: Annotated[str, typer.Option(help="faces of the shapes, about, with commas")] = "5000,50000",
) -> None:
    """CPU seconds a shape, over all threads, on wavy balls."""
    grid = build_hierarchy(cells, depth).finest
    _ = grid.centroids, grid.neighbors
    for count in faces.split(","):
        _measure(grid, *_wavy_ball(int(count)))


def _measure(grid: TetGrid, vertices: np.ndarray, faces: np.ndarray) -> None:
    typer.echo(f"{len(faces):,} faces, {len(grid.tets):,} tets")
    seconds, field = _timed("field", lambda: extract_field(vertices, faces, grid))
    brute, _ = _timed(f"brute force, {_SAMPLE} tets", lambda: _brute_force(vertices, faces, grid))
    typer.echo(
        f"  brute force on all would take {brute * len(grid.tets) / _SAMPLE / seconds:,.0f} times the field"
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "1-of-1.zarr.zip"
        _timed("store: write", lambda: write_shard(path, ["shape"], [field], grid.digest))
        _timed("store: open and read", lambda: ShardReader(path).read("shape"))
    operator, mu = vertex_operator(grid), _surface_mean(field, grid)
    _, mesh = _timed(
        "mesh, smoothed", lambda: build_solid(field, grid, operator, mu, MeshingOptions(), smoothing=True)
    )
    _timed("quality record", lambda: quality_record(mesh))


def _brute_force(vertices: np.ndarray, faces: np.ndarray, grid: TetGrid) -> None:
    """Distances to the corners of all faces: less than the true work, and without a sign."""
    for centroid in grid.centroids[:: len(grid.tets) // _SAMPLE][:_SAMPLE]:
        np.linalg.norm(vertices[faces] - centroid, axis=-1).min()


def _surface_mean(field: Field, grid: TetGrid) -> float:
    lengths = np.linalg.norm(field.displacement, axis=1)
    return float(lengths[surface_tets(field.occupancy, grid.neighbors)].mean())


def _wavy_ball(faces: int) -> tuple[np.ndarray, np.ndarray]:
    side = round(np.sqrt(faces / 4))
    ball = trimesh.creation.uv_sphere(radius=0.4, count=[side, side])
    waves = 1 + 0.05 * np.sin(30 * np.asarray(ball.vertices)).sum(axis=1, keepdims=True)
    return np.asarray(ball.vertices) * waves + 0.5, np.asarray(ball.faces, dtype=np.int64)


def _timed(name: str, work: Callable[[], Any]) -> tuple[float, Any]:
    start = process_time()
    result = work()
    seconds = process_time() - start
    typer.echo(f"  {name:26s}{seconds:9.4f} s")
    return seconds, result


if __name__ == "__main__":
    typer.run(main)
