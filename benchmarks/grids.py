"""How fast grids are built, beside the same work a tet at a time."""

from collections.abc import Callable
from time import process_time
from typing import Annotated, Any

import numpy as np
import typer

from tetgan.grids.hierarchy import GridHierarchy, build_hierarchy


def main(
    cells: Annotated[int, typer.Option(help="cells along each side of the cube: 2 for LR, 3 for HR")] = 2,
    depth: Annotated[int, typer.Option(help="subdivisions: 3 for the paper's grids")] = 3,
) -> None:
    """CPU seconds of the hierarchy and of the neighbours of all its levels."""
    built, hierarchy = _seconds(lambda: build_hierarchy(cells, depth))
    met, _ = _seconds(lambda: [grid.neighbors for grid in hierarchy.levels])
    loop, _ = _seconds(lambda: _naive_neighbors(hierarchy))
    tets = len(hierarchy.finest.tets)
    typer.echo(f"{tets:,} tets, {len(hierarchy.finest.vertices):,} vertices, depth {depth}")
    typer.echo(f"hierarchy            {built:8.3f} s")
    typer.echo(f"neighbours           {met:8.3f} s")
    typer.echo(f"neighbours by a dict {loop:8.3f} s, {loop / met:.0f} times as long")


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


def _seconds(work: Callable[[], Any]) -> tuple[float, Any]:
    start = process_time()
    result = work()
    return process_time() - start, result


if __name__ == "__main__":
    typer.run(main)
