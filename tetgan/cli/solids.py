"""Commands that certify solid meshes of any origin and convert them for other programs."""

from pathlib import Path
from typing import Annotated

import typer

from tetgan.cli.app import app, limit_libigl

PANEL = "Solids"


@app.command(rich_help_panel=PANEL)
def certify(
    meshes: Annotated[
        list[Path], typer.Argument(help="Tet meshes (.msh .vtu .vtk .mesh .inp .xdmf .npz …), or folders.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="Folder for a certificate (.json) a mesh and certificate.csv of all.")
    ] = None,
) -> None:
    """Check whether tet meshes are valid solids: one line per mesh, exit status 1 where one is not.

    Valid: no inverted tet, every boundary edge with two faces, every boundary vertex with one fan of them,
    and a boundary that does not meet itself.

    Example: `tetgan certify results/samples/chair/tetgan-LR/0/solid/wls/generated --out certificates`
    """
    limit_libigl(1)
    from tetgan.solids.certify import certify_files, verdict

    found = certify_files(meshes, out)
    for one in found:
        typer.echo(verdict(one))
    invalid = sum(not one.valid for one in found)
    if len(found) > 1:
        typer.echo(f"{len(found) - invalid} of {len(found)} meshes are valid")
    if invalid:
        raise typer.Exit(1)


@app.command(rich_help_panel=PANEL)
def export(
    mesh: Annotated[Path, typer.Argument(dir_okay=False, help="Tet mesh in any format that can be read.")],
    outputs: Annotated[
        list[Path],
        typer.Argument(
            help="Solids (.msh .vtu .vtk .mesh .inp .xdmf .npz) or surfaces (.ply .obj .stl .glb) to write."
        ),
    ],
    msh_version: Annotated[
        str, typer.Option(help="Version of Gmsh's format, 2.2 or 4.1; most solvers read 2.2.")
    ] = "2.2",
) -> None:
    """Write a tet mesh, or its boundary, in the formats of other programs; a format goes by its suffix.

    Example: `tetgan export chair.vtu chair.msh chair.inp chair.stl`
    """
    from tetgan.solids.export import write_mesh
    from tetgan.solids.reading import read_solid

    solid = read_solid(mesh)
    for path in outputs:
        write_mesh(path, solid, msh_version=msh_version)
