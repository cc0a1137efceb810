"""Command from any surface to a certified solid."""

from pathlib import Path
from typing import Annotated

import typer

from tetgan.cli.app import app, limit_libigl


@app.command(rich_help_panel="Solids")
def solidify(
    source: Annotated[Path, typer.Argument(help="Surface (.obj .off .ply .stl .glb), or a folder of them.")],
    target: Annotated[
        Path,
        typer.Argument(
            help="Solid (.vtu .msh .inp .vtk .mesh .xdmf .npz .usd …) or its boundary (.ply .obj .stl .off"
            " .glb) to write; or a folder, which also gets solidify.csv."
        ),
    ],
    edge: Annotated[
        str | None,
        typer.Option(
            help="Longest edge near the surface, in the mesh's units, or with a unit of its own (5mm) where"
            " --units tells what the mesh is in."
        ),
    ] = None,
    cells: Annotated[int, typer.Option(help="Edges along the longest side, where no --edge is given.")] = 48,
    units: Annotated[
        str | None,
        typer.Option(help="Unit of the mesh's coordinates, m, cm, mm or in; they stay as they are."),
    ] = None,
    repair: Annotated[
        str,
        typer.Option(
            help="none, manifold, alpha_wrap; auto: alpha_wrap where the surface encloses no volume."
        ),
    ] = "auto",
    alpha: Annotated[
        float, typer.Option(help="alpha_wrap: gaps up to twice this share of the longest side close.")
    ] = 0.02,
    interior: Annotated[str, typer.Option(help="Tets inside: graded (coarser inward) or fine.")] = "graded",
    min_dihedral: Annotated[float, typer.Option(help="Least dihedral angle, in degrees, up to 25.")] = 15.0,
    suffix: Annotated[str, typer.Option(help="Format of the solids in a folder.")] = ".vtu",
    workers: Annotated[int, typer.Option(min=1, help="Meshes at once, each in a process of its own.")] = 1,
    timeout: Annotated[float, typer.Option(help="Processor seconds after which a mesh is given up.")] = 600.0,
) -> None:
    """Make certified solids of surfaces, in their own units and place: repair if need be, cut, certify.

    Valid: every tet positive, all dihedral angles at least --min-dihedral, a manifold boundary that nowhere
    meets itself. A mesh of which no solid can be made is listed with the reason; exit status 1 then.

    Examples: `tetgan solidify chair.glb chair.vtu`

    `tetgan solidify scans solids --units m --edge 5mm --workers 2`
    """
    limit_libigl(1)
    from tetgan.meshing.solidify import SolidifyOptions
    from tetgan.meshing.solidify_files import solidify_files
    from tetgan.solids.units import parse_length

    options = SolidifyOptions.parse(
        {
            "edge": None if edge is None else parse_length(edge, units, "--edge"),
            "cells": cells,
            "units": units,
            "repair": repair,
            "alpha": alpha,
            "interior": interior,
            "min_dihedral": min_dihedral,
            "timeout_seconds": timeout,
        },
        "solidify",
    )
    found = solidify_files(source, target, options, workers=workers, suffix=suffix)
    for one in found:
        typer.echo(one.line())
    failed = sum(one.report is None for one in found)
    if len(found) > 1:
        typer.echo(f"{len(found) - failed} of {len(found)} meshes are solids now")
    if failed:
        raise typer.Exit(1)
