"""Study: the resolution that tetrahedra and voxels need to represent a torus equally well."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import igl
import numpy as np
import pandas as pd
from jaxtyping import Float
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.files import check_suffix, whole_file
from tetgan.geometry.triangles import TriangleMesh
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.rendering.plots import FIGURES
from tetgan.shapes.sampling import sample_surface
from tetgan.studies.options import ResolutionOptions
from tetgan.studies.resolution.report import draw_report, render_report
from tetgan.studies.resolution.representations import (
    BINARY,
    BLOCKY,
    DEFORMED,
    DISTANCE,
    NUMBERS,
    PAPER,
    UNDEFORMED,
    deformed_surface,
    undeformed_surface,
)
from tetgan.studies.resolution.torus import Torus
from tetgan.studies.resolution.voxels import voxel_surfaces
from tetgan.tables.markdown import write_twins

_log = logging.getLogger(__name__)


class SurfaceError(NamedTuple):
    """Mean distances between a surface and the torus, in cube sides."""

    to_torus: float
    from_torus: float

    @property
    def symmetric(self) -> float:
        return (self.to_torus + self.from_torus) / 2


def measure_resolution(options: ResolutionOptions, table: Path, figure: Path) -> None:
    """Measure every representation and write what each needs.

    Args:
        table: `.csv` of one row per representation, with a `.md` twin.
        figure: `.png`; every measurement that it shows is in a `.csv` beside it.

    Raises:
        UserError: both would write one file, or have another suffix.
    """
    check_suffix(table, "a table", ".csv")
    check_suffix(figure, "a figure", *FIGURES)
    if table == figure.with_suffix(".csv"):
        raise UserError(f"{table}: also the name of the figure's data; put the figure in another folder")
    torus = Torus(**options.torus.model_dump())
    curves = measure_curves(torus, options)
    summary = summarise(curves, options.reference_cells)
    write_twins(summary, render_report(summary, options), table)
    with whole_file(figure.with_suffix(".csv")) as partial:
        curves.to_csv(partial, index=False)
    with whole_file(figure) as partial:
        draw_report(partial, curves, summary, _pictured(torus, summary, options))


def measure_curves(torus: Torus, options: ResolutionOptions) -> pd.DataFrame:
    """One row per representation and resolution, in rising order.

    Columns: `representation`, `resolution` (cube root of the elements), `cells` (of a lattice), `elements`,
    `numbers` stored, `faces` of the surface, `error` and its halves `to_torus`, `from_torus`, in cube sides.
    """
    rows = []
    for name, cells, elements, surface in _surfaces(torus, options):
        error = surface_error(surface, torus, options.points, options.seed)
        rows.append(
            {
                "representation": name,
                "resolution": float(np.cbrt(elements)),
                "cells": cells,
                "elements": elements,
                "numbers": NUMBERS[name] * elements,
                "faces": len(surface.faces),
                "error": error.symmetric,
                "to_torus": error.to_torus,
                "from_torus": error.from_torus,
            }
        )
        _log.info("%s at %.1f^3: %.2e", name, rows[-1]["resolution"], error.symmetric)
    place = {name: number for number, name in enumerate(NUMBERS)}
    rows.sort(key=lambda row: (place[str(row["representation"])], row["resolution"]))
    return pd.DataFrame(rows).astype({"cells": "Int64"})


def surface_error(surface: TriangleMesh, torus: Torus, points: int, seed: int) -> SurfaceError:
    """Mean distances of points uniform on each surface to the other one, each of them exact."""
    drawn, _ = sample_surface(surface.vertices, surface.faces, points, seed)
    queries = torus.sample(points, seed)
    squared, _, _ = igl.point_mesh_squared_distance(queries, surface.vertices, surface.faces)
    return SurfaceError(
        to_torus=float(np.abs(torus.signed_distance(drawn)).mean()),
        from_torus=float(np.sqrt(squared.clip(min=0)).mean()),
    )


class Needed(NamedTuple):
    """A resolution or a size; sign '>' or '<': at least or at most that, beyond what was measured."""

    value: float
    sign: str = ""

    def __str__(self) -> str:
        shown = f"{self.value:.1f}" if self.value < 1000 else f"{self.value:.0f}"
        return f"{self.sign} {shown}".strip()


def resolution_to_reach(
    resolutions: Float[np.ndarray, "N"], errors: Float[np.ndarray, "N"], target: float
) -> Needed:
    """Where the error falls to the target for good, on straight lines between the logarithms.

    Args:
        resolutions: rising.
    """
    above = np.flatnonzero(errors > target)
    if len(above) == 0:
        return Needed(float(resolutions[0]), "<")
    last = above[-1]
    if last == len(errors) - 1:
        return Needed(float(resolutions[-1]), ">")
    pair = [last + 1, last]  # np.interp wants its first axis, here the error, to rise
    return Needed(float(np.exp(np.interp(np.log(target), np.log(errors[pair]), np.log(resolutions[pair])))))


def convergence_order(resolutions: Float[np.ndarray, "N"], errors: Float[np.ndarray, "N"]) -> float:
    """Power of 1/resolution with which the error falls: least squares on logarithms; nan for one point."""
    if len(resolutions) < 2:
        return np.nan
    return -float(np.polyfit(np.log(resolutions), np.log(errors), 1)[0])


def summarise(curves: pd.DataFrame, reference_cells: int) -> pd.DataFrame:
    """One row a representation: what it needs to reach the error of the deformed reference lattice.

    Args:
        curves: of `measure_curves`.

    Returns:
        Columns `representation`; `needed`, a resolution as text, '> X' where X is the finest measured and
        does not reach it; `needed_paper`; `numbers` stored at that resolution, as text likewise; `order` of
        convergence; `target`, the error to reach; `finest` resolution measured and the `finest_error` there.
    """
    deformed = curves[curves["representation"] == DEFORMED].set_index("cells")
    reference: dict[Any, Any] = deformed.loc[reference_cells].to_dict()
    rows = []
    for name, curve in curves.groupby("representation", sort=False):
        resolutions, errors = curve["resolution"].to_numpy(), curve["error"].to_numpy()
        needed = (
            Needed(float(reference["resolution"]))
            if name == DEFORMED
            else resolution_to_reach(resolutions, errors, float(reference["error"]))
        )
        rows.append(
            {
                "representation": name,
                "needed": str(needed),
                "needed_paper": PAPER.get(str(name)),
                "numbers": str(needed._replace(value=NUMBERS[str(name)] * needed.value**3)),
                "order": convergence_order(resolutions, errors),
                "target": reference["error"],
                "finest": resolutions[-1],
                "finest_error": errors[-1],
            }
        )
    return pd.DataFrame(rows).astype({"needed_paper": "Int64"})


def _surfaces(
    torus: Torus, options: ResolutionOptions
) -> Iterator[tuple[str, int | None, int, TriangleMesh]]:
    """Representation, lattice cells, number of elements and surface of everything that is measured."""
    lattices = sorted({*options.cells, *options.deformed_cells})
    for cells in track(lattices, "lattices", console=Console(stderr=True), transient=True):
        grid = build_hierarchy(cells, options.depth).finest
        if cells in options.cells:
            yield UNDEFORMED, cells, len(grid.tets), undeformed_surface(torus, grid)
        if cells in options.deformed_cells:
            yield DEFORMED, cells, len(grid.tets), deformed_surface(torus, grid)
    for side in track(options.voxels, "voxels", console=Console(stderr=True), transient=True):
        surfaces = voxel_surfaces(torus.signed_distance, side)
        yield BINARY, None, side**3, surfaces.binary
        yield BLOCKY, None, side**3, surfaces.blocky
        yield DISTANCE, None, side**3, surfaces.distance


def _pictured(torus: Torus, summary: pd.DataFrame, options: ResolutionOptions) -> dict[str, TriangleMesh]:
    """The torus itself, and each representation at about the resolution it needs, by title."""
    needed = summary.set_index("representation")["needed"].str.strip("<> ").astype(float)
    sides = {n: (12 * n**2 * (n + 1)) ** (1 / 3) * 2**options.depth for n in options.cells}
    cells = min(sides, key=lambda n: abs(np.log(sides[n] / needed[UNDEFORMED])))
    fine = build_hierarchy(cells, options.depth).finest
    reference = build_hierarchy(options.reference_cells, options.depth).finest
    binary, blocky, distance = (round(needed[name]) for name in (BINARY, BLOCKY, DISTANCE))
    return {
        "torus": torus.mesh(256, 128),
        f"{sides[cells]:.0f}³ {UNDEFORMED}": undeformed_surface(torus, fine),
        f"{needed[DEFORMED]:.0f}³ {DEFORMED}": deformed_surface(torus, reference),
        f"{binary}³ {BINARY}": voxel_surfaces(torus.signed_distance, binary).binary,
        f"{blocky}³ {BLOCKY}": voxel_surfaces(torus.signed_distance, blocky).blocky,
        f"{distance}³ {DISTANCE}": voxel_surfaces(torus.signed_distance, distance).distance,
    }
