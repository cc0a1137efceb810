"""Commands that certify solid meshes of any origin and convert them for other programs."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tetgan.cli.app import app, limit_libigl, read_options
from tetgan.errors import UserError

PANEL = "Solids"


@app.command(rich_help_panel=PANEL)
def certify(
    meshes: Annotated[
        list[Path],
        typer.Argument(help="Tet meshes (.msh .vtu .vtk .mesh .inp .xdmf .npz .usd …), or folders."),
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
            help="Solids (.msh .vtu .vtk .mesh .inp .xdmf .npz; .usda .usdc .usd with usd-core) or surfaces"
            " (.ply .obj .stl .off .glb) to write."
        ),
    ],
    msh_version: Annotated[
        str, typer.Option(help="Version of Gmsh's format, 2.2 or 4.1; most solvers read 2.2.")
    ] = "2.2",
    group: Annotated[
        list[str] | None,
        typer.Option(
            help="Named part of the boundary, name=region: a side (floor, top, left, right, back, front), a"
            " box 'seat=0,0.4,0:1,0.5,1', a plane 'foot=y=0', a side of one 'low=y<0.1'; in the mesh's units."
            " May be repeated; floor, top and surface are there by themselves. Groups are sets in .inp,"
            " physical groups in .msh, 0 or 1 in .vtu, .vtk and .xdmf; other formats have none."
        ),
    ] = None,
    reach: Annotated[float, typer.Option(help="Depth of a side, over the mesh's longest extent.")] = 0.05,
    order: Annotated[
        int,
        typer.Option(
            help="Degree of the elements; 2 has nodes on the edges too (.msh .vtu .vtk .inp .xdmf). Surfaces"
            " are the same in both."
        ),
    ] = 1,
    onto: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False,
            help="Surface, in the mesh's units, onto which --order 2 moves the middles of boundary edges,"
            " where the tets stay valid.",
        ),
    ] = None,
    units: Annotated[
        str, typer.Option(help="Unit to write, m, cm, mm or in; --scale tells what a unit of the mesh is.")
    ] = "m",
    scale: Annotated[float, typer.Option(help="Metres per unit of the mesh.")] = 1.0,
    material: Annotated[
        str | None,
        typer.Option(
            help="Material for .inp: pinewood, steel, rubber, or '{young: 1e10, poisson: 0.3, density: 500}';"
            " in the units that go with --units."
        ),
    ] = None,
) -> None:
    """Write a tet mesh, or its boundary, in the formats of other programs; a format goes by its suffix.

    Examples: `tetgan export chair.vtu chair.msh chair.inp chair.stl`

    `tetgan export chair.vtu chair.inp --order 2 --units mm --scale 0.8 --material steel --group 'seat=y=0.4'`
    """
    from tetgan.solids.elements import linear_elements, quadratic_elements, scaled
    from tetgan.solids.export import write_mesh
    from tetgan.solids.groups import choose_groups, parse_groups
    from tetgan.solids.options import ExportOptions
    from tetgan.solids.reading import read_solid
    from tetgan.solids.units import UNITS

    values = {"order": order, "units": units, "scale": scale, "reach": reach}
    options = ExportOptions.parse(values, "export")
    system = UNITS[options.units]
    section = None if material is None else _section(material, outputs, system)
    solid = read_solid(mesh)
    groups = choose_groups(solid, parse_groups(group or []), options.reach)
    elements = (linear_elements if options.order == 1 else quadratic_elements)(solid, groups)
    if onto is not None:
        elements = _curve(elements, onto)
    elements = scaled(elements, options.scale / system.length)
    for path in outputs:
        write_mesh(path, elements, msh_version=msh_version, system=system, section=section)


def _curve(elements: Any, onto: Path) -> Any:
    """Elements of degree 2 on a surface from a file; tells how many edges are curved."""
    from tetgan.solids.curving import curve_onto
    from tetgan.solids.reading import read_surface

    if elements.order == 1:
        raise UserError(f"--onto: {onto}: only elements of degree 2 have nodes to move; add --order 2")
    surface = read_surface(onto)
    if surface is None:
        raise UserError(f"--onto: {onto}: no surface there; give a file of triangles, such as .ply")
    curved = curve_onto(elements, surface)
    typer.echo(f"boundary edges: {curved.moved:,} on the surface, {curved.straight:,} straight")
    return curved.elements


def _section(material: str, outputs: list[Path], system: Any) -> Any:
    """A preset, or a material from numbers, in the units of the file."""
    from tetgan.mechanics.materials import MATERIALS, Material, read_material, section_of

    if not any(path.suffix.lower() == ".inp" for path in outputs):
        raise UserError(f"--material: '{material}' can be written into .inp alone; add such a file")
    if material.lstrip().startswith("{"):
        return section_of("material", read_options(Material, material, "--material"), system)
    return section_of(read_material(material), MATERIALS[material], system)
