"""Time to build grids, beside a loop over tets."""

from typing import Annotated

import numpy as np
import typer
from records import Records, cpu_seconds, record

from tetgan.grids.hierarchy import GridHierarchy, build_hierarchy

GRIDS = {"LR": 2, "HR": 3}
"""Cells a side of the paper's grids, at depth 3."""


def run(quick: bool) -> Records:
    """Hierarchies with the neighbours of all levels, and their cost against the tets of the finest."""
    found: Records = {}
    for name, cells in GRIDS.items():
        seconds, hierarchy = cpu_seconds(lambda cells=cells: _build(cells, 3), repeats=1 if quick else 3)
        target = 1.0 if name == "LR" else None
        found[f"grid, {name} ({len(hierarchy.finest.tets):,} tets)"] = record(seconds, "CPU-s", target)
    for cells in (1, 2) if quick else (1, 2, 3, 4):
        for depth in (1, 2, 3):
            seconds, hierarchy = cpu_seconds(lambda cells=cells, depth=depth: _build(cells, depth))
            found[f"grid [tets={len(hierarchy.finest.tets)}]"] = record(seconds, "CPU-s")
    ratio = _loop_ratio(2, 2 if quick else 3)
    found["neighbours by a dictionary / ours"] = record(ratio, "times", better="higher")
    return found


def main(
    cells: Annotated[int, typer.Option(help="cells along each side of the cube: 2 for LR, 3 for HR")] = 2,
    depth: Annotated[int, typer.Option(help="subdivisions: 3 for the paper's grids")] = 3,
) -> None:
    """CPU seconds of the hierarchy and of the neighbours of all its levels."""
    built, hierarchy = cpu_seconds(lambda: build_hierarchy(cells, depth))
    met, _ = cpu_seconds(lambda: [grid.neighbors for grid in hierarchy.levels])
    tets = len(hierarchy.finest.tets)
    typer.echo(f"{tets:,} tets, {len(hierarchy.finest.vertices):,} vertices, depth {depth}")
    typer.echo(f"hierarchy            {built:8.3f} s")
    typer.echo(f"neighbours           {met:8.3f} s")
    typer.echo(f"neighbours by a dict {_loop_ratio(cells, depth):.0f} times as long")


def _build(cells: int, depth: int) -> GridHierarchy:
    hierarchy = build_hierarchy(cells, depth)
    for grid in hierarchy.levels:
        _ = grid.neighbors
    return hierarchy


def _loop_ratio(cells: int, depth: int) -> float:
    """How many times as long a loop over tets takes to find the neighbours."""
    hierarchy = build_hierarchy(cells, depth)
    ours, _ = cpu_seconds(lambda: [grid.neighbors for grid in hierarchy.levels])
    loop, _ = cpu_seconds(lambda: _naive_neighbors(hierarchy))
    return loop / ours


def _naive_neighbors(hierarchy: GridHierarchy) -> None:
    for grid in hierarchy.levels:
        neighbors = np.full(grid.tets.shape, -1)
        waiting: dict[frozenset[int], tuple[int, int]] = {}
        for tet, corners in enumerate(grid.tets.tolist()):
            for slot in range(4):
                face = frozenset(corners[:slot] + corners[slot + 1 :])
                if face in waiting:
                    other, other_slot = waiting.pop(face)
                    neighbors[tet, slot], neighbors[other, other_slot] = other, tet
                else:
                    waiting[face] = (tet, slot)
        if not np.array_equal(neighbors, grid.neighbors):
            raise AssertionError("the loop and the grid disagree")


if __name__ == "__main__":
    typer.run(main)
