"""Validity, faithfulness to the shape and cost of solids, on fields of several classes.

python benchmarks/solids.py                                        noise, and exact shapes there and back
python benchmarks/solids.py --model MODEL --index INDEX            and what a model samples and reconstructs
python benchmarks/solids.py --index INDEX --meshes 1-of-16.zip     and repaired shapes there and back
"""

from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from time import process_time
from typing import Annotated, Any, NamedTuple

import igl
import numpy as np
import pandas as pd
import trimesh
import typer
from jaxtyping import Bool
from rich.console import Console
from rich.progress import track
from scipy import ndimage

from tetgan.fields.extraction import extract_field
from tetgan.fields.field import Field, VertexField, surface_tets, vertex_operator
from tetgan.fields.store import FieldStore
from tetgan.geometry.adjacency import EDGES
from tetgan.geometry.tets import dihedral_angles
from tetgan.geometry.triangles import TriangleMesh
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.models.files import load_generator
from tetgan.models.sampling import generate_fields, reconstruct_fields
from tetgan.rendering.raycast import render_mesh
from tetgan.rendering.sheet import contact_sheet, save_image
from tetgan.shapes.archive import read_meshes
from tetgan.solids.certificate import Certificate, certify
from tetgan.solids.solid import SolidMesh

SOLID, PAPER = MeshingOptions(), MeshingOptions(mode="paper")
_POINTS = 5000  # of each surface, for distances


class Case(NamedTuple):
    """A field to mesh, the mean displacement of surface tets, and the shape it is of, if any."""

    field: Field | VertexField
    mu: float
    shape: TriangleMesh | None = None


def main(  # noqa: PLR0917 - options, not positions
    cells: Annotated[int, typer.Option(help="cells along each side of the cube; not with --index")] = 2,
    depth: Annotated[int, typer.Option(help="subdivisions; not with --index")] = 2,
    count: Annotated[int, typer.Option(help="fields of each class")] = 300,
    index: Annotated[Path | None, typer.Option(help="index of fields")] = None,
    model: Annotated[Path | None, typer.Option(help="trained model of these fields")] = None,
    meshes: Annotated[list[Path] | None, typer.Option(help="zips of repaired meshes")] = None,
    only: Annotated[str, typer.Option(help="classes, with commas")] = "",
    out: Annotated[Path | None, typer.Option(help="table (.csv) of all fields")] = None,
    picture: Annotated[Path | None, typer.Option(help="picture (.png) of eight fields of each class")] = None,
) -> None:
    """Print a summary of each class; or draw eight fields of each: the shape, mode paper and mode solid."""
    grid, classes = build_hierarchy(cells, depth).finest, {}
    if index is not None:
        grid, classes = _of_store(index, model, count)
    classes |= {"noise": noise(grid, count), "exact": exact(grid)}
    if meshes:
        classes["truth"] = there_and_back(grid, meshes, count)
    tables = []
    for name, cases in classes.items():
        if only and name not in only.split(","):
            continue
        if picture is not None:
            draw(picture.with_stem(f"{picture.stem}-{name}"), list(islice(cases, 8)), grid)
            continue
        tables.append(measure(name, cases, grid))
        typer.echo(summary(tables[-1]).to_string())
        if out is not None:
            pd.concat(tables).to_csv(out, index=False)


def run(quick: bool) -> dict[str, dict[str, Any]]:
    """Figures for the table of benchmarks: noise on the small lattice, exact shapes on the paper's LR."""
    small = build_hierarchy(2, 1).finest
    large = small if quick else build_hierarchy(2, 3).finest
    found = {}
    for name, cases, grid in (
        ("noise", noise(small, 6 if quick else 300), small),
        ("exact", exact(large), large),
    ):
        rows = measure(name, cases, grid)
        found |= {
            f"solids.{name}.violations": _figure(rows["violations"].sum(), "count", 0),
            f"solids.{name}.min_dihedral": _figure(
                rows["min_dihedral"].min(), "degrees", 15, better="higher"
            ),
            f"solids.{name}.seconds": _figure(rows["seconds"].max(), "s", 1 if name == "exact" else None),
        }
    found["solids.exact.volume_error"] = _figure(
        (rows["volume_ratio"] - 1).abs().median(), "of the shape's", 0.03
    )
    found["solids.exact.acceptable"] = _figure(
        rows["acceptable"].mean(), "of the tets", 0.85, better="higher"
    )
    return found


def measure(name: str, cases: Iterable[Case], grid: TetGrid) -> pd.DataFrame:
    """A row for each case: with smoothing (Eq. 4) and without, in turns."""
    operator, rows = vertex_operator(grid), []
    for number, case in enumerate(track(cases, description=name, console=Console(stderr=True))):
        smoothing = bool(number % 2)
        faithful = build_solid(case.field, grid, operator, case.mu, PAPER, smoothing=smoothing)
        if number == 0:  # what is made once a grid
            build_solid(case.field, grid, operator, case.mu, SOLID, smoothing=smoothing)
        start = process_time()
        mesh = build_solid(case.field, grid, operator, case.mu, SOLID, smoothing=smoothing)
        seconds = process_time() - start
        if len(mesh.tets):
            rows.append(
                {"class": name, "smoothing": smoothing, "seconds": seconds, **_row(mesh, faithful, case)}
            )
    return pd.DataFrame(rows)


def draw(path: Path, cases: list[Case], grid: TetGrid) -> None:
    """A column a field: the shape, if it is known, the mesh of mode `paper`, and that of mode `solid`."""
    operator = vertex_operator(grid)
    rows = {"shape": [case.shape for case in cases if case.shape is not None]}
    for options in (PAPER, SOLID):
        rows[options.mode] = [
            build_solid(case.field, grid, operator, case.mu, options, smoothing=False) for case in cases
        ]
    shown = {name: meshes for name, meshes in rows.items() if meshes}
    images = [
        render_mesh(mesh.vertices, mesh.faces, size=(200, 200))
        for meshes in shown.values()
        for mesh in meshes
    ]
    save_image(path, contact_sheet(images, len(cases), row_titles=list(shown)))


def summary(rows: pd.DataFrame) -> pd.Series:
    """What the targets speak of."""
    by = rows["class"].iloc[0]
    return pd.Series(
        {
            "fields": len(rows),
            "tets, median": rows["tets"].median(),
            "inverted tets": rows["inverted"].sum(),
            "non-manifold edges": rows["edges"].sum(),
            "non-manifold vertices": rows["vertices"].sum(),
            "self-intersections": rows["crossings"].sum(),
            "meshes not valid": (~rows["valid"]).sum(),
            "least dihedral": rows["min_dihedral"].min(),
            "acceptable, mean": rows["acceptable"].mean(),
            "held back, mean": rows["held"].mean(),
            "dropped volume, mean": rows["dropped_volume"].mean(),
            "volume to shape, median": rows["volume_ratio"].median(),
            "volume error, median": (rows["volume_ratio"] - 1).abs().median(),
            "volume error, 95 %": (rows["volume_ratio"] - 1).abs().quantile(0.95),
            "squared distance e-4, median": rows["distance"].median(),
            "pieces as the shape": rows["pieces_as_shape"].mean(),
            "paper: volume to shape, median": rows["paper_volume_ratio"].median(),
            "paper: squared distance e-4, median": rows["paper_distance"].median(),
            "paper: inverted, mean": rows["paper_inverted"].mean(),
            "paper: valid": rows["paper_valid"].sum(),
            "seconds, median": rows["seconds"].median(),
            "seconds, most": rows["seconds"].max(),
        },
        name=by,
    )


def noise(grid: TetGrid, count: int) -> Iterator[Case]:
    """Every tet for itself, or blobs; shares from a tenth to nine; displaced by nothing up to everything."""
    for seed in range(count):
        rng = np.random.default_rng(seed)
        share, size = 0.1 * (1 + seed % 9), (0.0, 0.02, 0.1, 1.0)[seed // 9 % 4]
        values = rng.random(len(grid.tets))
        if seed // 36 % 2:
            blobs = ndimage.gaussian_filter(rng.normal(size=(32, 32, 32)), 2.0)
            values = blobs[tuple((grid.centroids * 32).astype(int).T)]
        displacement = rng.normal(scale=size, size=(len(grid.tets), 3)).astype(np.float32)
        yield Case(Field(values < np.quantile(values, share), displacement), 1.0)


def exact(grid: TetGrid) -> Iterator[Case]:
    """Shapes given by formulas, there and back, without smoothing and with."""
    shapes = [
        trimesh.creation.icosphere(subdivisions=4, radius=0.4),
        trimesh.creation.torus(0.33, 0.12, major_sections=96, minor_sections=48),
        trimesh.creation.torus(0.4, 0.05, major_sections=96, minor_sections=48),
        trimesh.creation.box((0.83, 0.57, 0.41)),
        trimesh.creation.box((0.96, 0.96, 0.7)),
        trimesh.creation.box((0.9, 0.7, 0.05)),
        trimesh.creation.cylinder(0.2, 0.9, sections=64),
        trimesh.creation.cone(0.4, 0.8, sections=64).apply_translation((0, 0, -0.4)),
        trimesh.creation.capsule(0.5, 0.15).apply_translation((0, 0, -0.25)),
    ]
    for shape in shapes:
        soup = TriangleMesh(np.array(shape.vertices) + 0.5, np.array(shape.faces, dtype=np.int64))
        yield from 2 * [_truth(soup, grid)]


def there_and_back(grid: TetGrid, meshes: list[Path], count: int) -> Iterator[Case]:
    """Fields of repaired shapes."""
    for _, vertices, faces in [each for path in meshes for each in read_meshes(path)][:count]:
        yield _truth(TriangleMesh(vertices.astype(np.float64), faces.astype(np.int64)), grid)


def _truth(soup: TriangleMesh, grid: TetGrid) -> Case:
    field = extract_field(soup.vertices, soup.faces, grid)
    lengths = np.linalg.norm(field.displacement, axis=1)
    surface = surface_tets(field.occupancy, grid.neighbors)
    return Case(field, float(lengths[surface].mean()) if surface.any() else 1.0, soup)


def _of_store(index: Path, model: Path | None, count: int) -> tuple[TetGrid, dict[str, Iterator[Case]]]:
    """The grid of an index; and fields that a model samples, and reconstructs of validation shapes first."""
    store = FieldStore.open(index)
    grid = store.hierarchy.finest
    if model is None:
        return grid, {}
    generator = load_generator(model, store.hierarchy)
    ids = [*store.ids("validation"), *store.ids("train")][:count]
    return grid, {
        "sampled": (Case(field, store.mu) for field in generate_fields(generator, store, count, 0)),
        "reconstructed": (Case(field, store.mu) for _, field, _ in reconstruct_fields(generator, store, ids)),
    }


def _row(mesh: SolidMesh, faithful: SolidMesh, case: Case) -> dict[str, Any]:
    found, before = (certify(each.vertices, each.tets) for each in (mesh, faithful))
    volume, pieces = np.nan, np.nan
    distances = [np.nan, np.nan]
    if case.shape is not None:
        volume, pieces = case.shape.volume, case.shape.components
        distances = [_distance(each, case.shape) for each in (mesh, faithful)]
    return {
        "tets": found.tets,
        "valid": found.valid,
        "inverted": found.inverted_tets,
        "edges": found.nonmanifold_edges,
        "vertices": found.nonmanifold_vertices,
        "crossings": found.self_intersections,
        "violations": _violations(found),
        "min_dihedral": found.min_dihedral,
        "acceptable": acceptable(mesh).mean(),
        "held": mesh.changes.held / (found.faces / 2),
        "dropped_volume": sum(mesh.changes.dropped),
        "cavities": found.cavities,
        "volume_ratio": found.volume / volume,
        "distance": distances[0],
        "pieces_as_shape": float(found.components == pieces) if not np.isnan(pieces) else np.nan,
        "paper_volume_ratio": before.volume / volume,
        "paper_distance": distances[1],
        "paper_inverted": before.inverted_tets / before.tets,
        "paper_valid": before.valid,
    }


def acceptable(mesh: SolidMesh) -> Bool[np.ndarray, "T"]:
    """Tets within the ranges that VTK calls acceptable: dihedral angles ≥ 40°, scaled Jacobian ≥ 0.5.

    The scaled Jacobian is the square root of two times six volumes over the largest product of three edges
    at a corner; 1 for a regular tet.
    """
    corners = mesh.vertices[mesh.tets]
    lengths = np.linalg.norm(corners[:, EDGES[:, 0]] - corners[:, EDGES[:, 1]], axis=2)
    at_corner = [np.flatnonzero((corner == EDGES).any(axis=1)) for corner in range(4)]
    products = np.stack([lengths[:, edges].prod(axis=1) for edges in at_corner], axis=1).max(axis=1)
    scaled = np.sqrt(2) * 6 * mesh.volumes / products
    return (dihedral_angles(mesh.vertices, mesh.tets).min(axis=1) >= 40) & (scaled >= 0.5)


def _violations(found: Certificate) -> int:
    return (
        found.inverted_tets + found.nonmanifold_edges + found.nonmanifold_vertices + found.self_intersections
    )


def _distance(mesh: SolidMesh, shape: TriangleMesh) -> float:
    """Mean squared distance from points uniform by area to the other surface, both ways added, times 1e4."""
    one, other = (mesh.vertices, mesh.faces), (shape.vertices, shape.faces)
    return 1e4 * (_one_way(one, other) + _one_way(other, one))


def _one_way(start: tuple[np.ndarray, np.ndarray], end: tuple[np.ndarray, np.ndarray]) -> float:
    surface = trimesh.Trimesh(*start, process=False)
    points = np.asarray(trimesh.sample.sample_surface(surface, _POINTS, seed=0)[0])
    squared, _, _ = igl.point_mesh_squared_distance(points, *end)
    return float(squared.mean())


def _figure(value: float, unit: str, target: float | None, better: str = "lower") -> dict[str, Any]:
    return {"value": float(value), "unit": unit, "target": target, "better": better, "device": "cpu"}


if __name__ == "__main__":
    typer.run(main)
