"""Time to simulate a large body.

python benchmarks/simulation.py --cells 10 --depth 1 --order 2
"""

from typing import Annotated

import typer
from records import Records, cpu_seconds, record

from tetgan.geometry.tets import TetMesh
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.mechanics.options import LoadCase
from tetgan.mechanics.simulation import Simulation, simulate

TARGET = 60.0  # seconds for a hundred thousand tets


def run(quick: bool) -> Records:
    """A cube of wood on the floor with 500 N on top, in elements of both degrees, and cost against tets."""
    found: Records = {}
    for order in (1, 2):
        for cells in (2, 3) if quick else (3, 5, 10):
            seconds, result = _load_cube(cells, 1, order)
            found[f"elasticity, degree {order} [tets={len(result.tets)}]"] = record(seconds, "CPU-s")
        name = f"elasticity, degree {order}, {len(result.tets):,} tets"
        found[name] = record(seconds, "CPU-s", None if quick else TARGET)
    return found


def main(
    cells: Annotated[int, typer.Option(help="cells along each side of the cube")] = 10,
    depth: Annotated[int, typer.Option(help="subdivisions of the cells")] = 1,
    order: Annotated[int, typer.Option(min=1, max=2, help="degree of the elements")] = 1,
) -> None:
    """CPU seconds, unknowns and iterations."""
    seconds, result = _load_cube(cells, depth, order)
    figures = result.record()
    typer.echo(f"{len(result.tets):,} tets, {figures['unknowns']:,} unknowns")
    typer.echo(
        f"{seconds:8.2f} CPU-s, {figures['iterations']} iterations, residual {figures['residual']:.1e}"
    )


def _load_cube(cells: int, depth: int, order: int) -> tuple[float, Simulation]:
    grid = build_hierarchy(cells, depth).finest
    cube = TetMesh(grid.vertices, grid.tets)
    return cpu_seconds(lambda: simulate(cube, LoadCase(order=order)))


if __name__ == "__main__":
    typer.run(main)
