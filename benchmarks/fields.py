"""Time of a shape's field, its storage and its mesh, beside brute force."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import igl
import numpy as np
import trimesh
import typer
from records import Records, cpu_seconds, record

from tetgan.fields.extraction import extract_field
from tetgan.fields.field import Field, surface_tets, vertex_operator
from tetgan.fields.store import ShardReader, write_shard
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions, Mode
from tetgan.solids.record import quality_record

_SAMPLE = 200  # tets on which brute force is tried, to be scaled up to all
_CHECKED = 20  # tets whose distances are computed to every triangle
_GRIDS = {"LR": 2, "HR": 3}
_TARGETS = {("LR", 5_000): 0.5, ("LR", 50_000): 1.0, ("HR", 5_000): 1.5, ("HR", 50_000): 3.0}
_MESH_TARGETS: dict[str, dict[Mode, float | None]] = {
    "LR": {"paper": 0.05, "solid": 1.0},
    "HR": {"paper": None, "solid": None},
}


def run(quick: bool) -> Records:
    """Fields and meshes on both of the paper's grids, and cost against faces and tets."""
    found: Records = {}
    repeats = 1 if quick else 3
    for name, cells in _GRIDS.items():
        grid = _ready_grid(cells, 3)
        for faces in (5_000,) if quick else (5_000, 50_000):
            ball = wavy_ball(faces)
            seconds, field = cpu_seconds(lambda grid=grid, ball=ball: extract_field(*ball, grid), repeats)
            found[f"field, {name}, {faces:,} faces"] = record(seconds, "CPU-s", _TARGETS[name, faces])
            error = distance_error(*ball, grid, field)
            found[f"field, {name}, {faces:,} faces: error of a distance"] = record(error, "cube sides", 1e-6)
            if faces == 5_000:
                for mode, target in _MESH_TARGETS[name].items():
                    seconds = _mesh_seconds(field, grid, mode, repeats)
                    found[f"mesh, {name}, mode {mode}"] = record(seconds, "CPU-s", target)
    grid = _ready_grid(2, 2 if quick else 3)
    for faces in (500, 2_000) if quick else (500, 2_000, 8_000, 32_000, 128_000):
        ball = wavy_ball(faces)
        seconds, _ = cpu_seconds(lambda ball=ball: extract_field(*ball, grid))
        found[f"field, {len(grid.tets):,} tets [faces={len(ball[1])}]"] = record(seconds, "CPU-s")
    ball = wavy_ball(5_000)
    for cells, depth in ((1, 2), (2, 2)) if quick else ((1, 2), (2, 2), (3, 2), (2, 3), (3, 3), (4, 3)):
        grid = _ready_grid(cells, depth)
        seconds, field = cpu_seconds(lambda grid=grid: extract_field(*ball, grid))
        found[f"field, 5,000 faces [tets={len(grid.tets)}]"] = record(seconds, "CPU-s")
        for mode in _MESH_TARGETS["HR"]:
            seconds = _mesh_seconds(field, grid, mode, repeats)
            found[f"mesh, mode {mode} [tets={len(grid.tets)}]"] = record(seconds, "CPU-s")
    return found


def main(
    cells: Annotated[int, typer.Option(help="cells along each side of the cube: 2 for LR, 3 for HR")] = 2,
    depth: Annotated[int, typer.Option(help="subdivisions: 3 for the paper's grids")] = 3,
    faces: Annotated[str, typer.Option(help="faces of the shapes, about, with commas")] = "5000,50000",
) -> None:
    """CPU seconds a shape, over all threads, on wavy balls."""
    grid = _ready_grid(cells, depth)
    for count in faces.split(","):
        _measure(grid, *wavy_ball(int(count)))


def _ready_grid(cells: int, depth: int) -> TetGrid:
    """A grid whose derived arrays are there: a stage makes them once for many shapes."""
    grid = build_hierarchy(cells, depth).finest
    _ = grid.centroids, grid.neighbors
    return grid


def _mesh_seconds(field: Field, grid: TetGrid, mode: Mode, repeats: int) -> float:
    """Filter, displace and smooth; in mode `solid`, so that the mesh is valid."""
    operator, mu, options = vertex_operator(grid), _surface_mean(field, grid), MeshingOptions(mode=mode)
    return cpu_seconds(lambda: build_solid(field, grid, operator, mu, options, smoothing=True), repeats)[0]


def distance_error(vertices: np.ndarray, faces: np.ndarray, grid: TetGrid, field: Field) -> float:
    """Largest difference to the distance to every triangle, over some tets."""
    tets = np.linspace(0, len(grid.tets) - 1, _CHECKED).astype(int)
    exact = [_distance_to_all(vertices, faces, point) for point in grid.centroids[tets]]
    return float(np.abs(np.linalg.norm(field.displacement[tets], axis=1) - exact).max())


def _distance_to_all(vertices: np.ndarray, faces: np.ndarray, point: np.ndarray) -> float:
    """Distance to each triangle by its own closest point, without a tree."""
    closest = trimesh.triangles.closest_point(vertices[faces], np.tile(point, (len(faces), 1)))
    return float(np.linalg.norm(closest - point, axis=1).min())


def _measure(grid: TetGrid, vertices: np.ndarray, faces: np.ndarray) -> None:
    typer.echo(f"{len(faces):,} faces, {len(grid.tets):,} tets")
    seconds, field = _timed("field", lambda: extract_field(vertices, faces, grid))
    _timed("of which closest points", lambda: _closest(vertices, faces, grid))
    brute, _ = _timed(f"brute force, {_SAMPLE} tets", lambda: _brute_force(vertices, faces, grid))
    typer.echo(
        f"  brute force on all would take {brute * len(grid.tets) / _SAMPLE / seconds:,.0f} times the field"
    )
    typer.echo(f"  largest error of a distance {distance_error(vertices, faces, grid, field):.1e}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "1-of-1.zarr.zip"
        _timed("store: write", lambda: write_shard(path, ["shape"], [field], grid.digest))
        _timed("store: open and read", lambda: ShardReader(path).read("shape"))
    operator, mu = vertex_operator(grid), _surface_mean(field, grid)
    for mode in _MESH_TARGETS["LR"]:
        options = MeshingOptions(mode=mode)
        _, mesh = _timed(
            f"mesh, smoothed, mode {mode}",
            lambda options=options: build_solid(field, grid, operator, mu, options, smoothing=True),
        )
    _timed("quality record", lambda: quality_record(mesh))


def _closest(vertices: np.ndarray, faces: np.ndarray, grid: TetGrid) -> None:
    igl.point_mesh_squared_distance(grid.centroids, vertices, faces)


def _brute_force(vertices: np.ndarray, faces: np.ndarray, grid: TetGrid) -> None:
    """Distances to the corners of all faces: less than the true work, and without a sign."""
    for centroid in grid.centroids[:: len(grid.tets) // _SAMPLE][:_SAMPLE]:
        np.linalg.norm(vertices[faces] - centroid, axis=-1).min()


def _surface_mean(field: Field, grid: TetGrid) -> float:
    lengths = np.linalg.norm(field.displacement, axis=1)
    return float(lengths[surface_tets(field.occupancy, grid.neighbors)].mean())


def wavy_ball(faces: int) -> tuple[np.ndarray, np.ndarray]:
    """A ball with waves on it, of about `faces` faces."""
    side = round(np.sqrt(faces / 4))
    ball = trimesh.creation.uv_sphere(radius=0.4, count=[side, side])
    waves = 1 + 0.05 * np.sin(30 * np.asarray(ball.vertices)).sum(axis=1, keepdims=True)
    return np.asarray(ball.vertices) * waves + 0.5, np.asarray(ball.faces, dtype=np.int64)


def _timed(name: str, work: Callable[[], Any]) -> tuple[float, Any]:
    seconds, result = cpu_seconds(work)
    typer.echo(f"  {name:26s}{seconds:9.4f} s")
    return seconds, result


if __name__ == "__main__":
    typer.run(main)
