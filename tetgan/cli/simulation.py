"""Commands for elasticity of solids under load."""

from pathlib import Path
from typing import Annotated

import typer

from tetgan.cli.app import OptionsText, app, read_options, read_plain
from tetgan.errors import UserError

PANEL = "Solids"


@app.command(rich_help_panel=PANEL)
def simulate(
    mesh: Annotated[
        Path, typer.Argument(dir_okay=False, help="Tet mesh: .vtu, .msh, or any format of meshio.")
    ],
    material: Annotated[
        str, typer.Option(help="pinewood, steel, rubber, or '{young: 1e10, poisson: 0.3, density: 500}'.")
    ] = "pinewood",
    fix: Annotated[
        list[str] | None,
        typer.Option(
            help="Region held still: floor, top, left, right, back, front, surface, a box x,y,z:x,y,z, a"
            " plane 'y=0', or a side of one 'y<0.1', in the mesh's units; floor/y holds one direction alone."
            " May be repeated.  [default: floor]"
        ),
    ] = None,
    load: Annotated[
        list[str] | None,
        typer.Option(
            help="Region and total force: top=500N (downward), left=200,0,-50N (a vector). May be repeated."
            "  [default: top=500N]"
        ),
    ] = None,
    gravity: Annotated[bool, typer.Option(help="Add the body's own weight.")] = False,
    size: Annotated[float, typer.Option(help="Metres per unit of the mesh.")] = 1.0,
    order: Annotated[int, typer.Option(help="Degree of the elements; degree 1 is too stiff in bending.")] = 2,
    refine: Annotated[int, typer.Option(help="Times that each tet is cut into eight first.")] = 0,
    reach: Annotated[float, typer.Option(help="Depth of a side, over the mesh's longest extent.")] = 0.05,
    largest: Annotated[
        bool, typer.Option(help="Simulate the largest piece alone; tells the share of the volume left out.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Mesh (.vtu, .vtk) to write, with displacement and stress.")
    ] = None,
    figure: Annotated[
        Path | None, typer.Option(help="Picture (.png) to write; with its data (.csv) beside it.")
    ] = None,
) -> None:
    """Bend a solid: displacement and von Mises stress under loads, by linear elasticity.

    Example: `tetgan simulate table.vtu --material pinewood --fix floor --load top=500N --size 0.8
    --out bent.vtu --figure bent.png`
    """
    from dataclasses import replace

    from rich.console import Console
    from rich.table import Table

    from tetgan.files import check_suffix
    from tetgan.mechanics.figure import write_figure
    from tetgan.mechanics.materials import Material, read_material
    from tetgan.mechanics.options import LoadCase
    from tetgan.mechanics.pieces import largest_piece, share_left_out
    from tetgan.mechanics.simulation import BODIES, readable_record, write_simulation
    from tetgan.mechanics.simulation import simulate as run
    from tetgan.rendering.plots import FIGURES
    from tetgan.solids.reading import read_solid

    if out is not None:
        check_suffix(out, "a simulated mesh", *BODIES)
    if figure is not None:
        check_suffix(figure, "a figure", *FIGURES)
    numbers = material.lstrip().startswith("{")
    values = {
        "material": read_options(Material, material, "--material") if numbers else read_material(material),
        "gravity": gravity,
        "size": size,
        "order": order,
        "refine": refine,
        "reach": reach,
    }
    values |= {name: given for name, given in (("fix", fix), ("load", load)) if given}
    case = LoadCase.parse(values, "simulate")
    solid = read_solid(mesh)
    try:
        piece = largest_piece(solid) if largest else solid
        result = replace(run(piece, case), left_out=share_left_out(solid, piece))
    except UserError as error:
        raise UserError(f"{mesh}: {error}") from None
    if out is not None:
        write_simulation(out, result)
    if figure is not None:
        write_figure(figure, result, mesh.stem)
    table = Table(title=mesh.name, show_header=False)
    for name, value in readable_record(result).items():
        table.add_row(name, value)
    Console().print(table)


@app.command(rich_help_panel=PANEL)
def simulate_samples(
    samples: Annotated[Path, typer.Argument(help="Folder written by `tetgan sample`.")],
    out: Annotated[Path, typer.Argument(help="Table (.csv) to write, one row per sample.")],
    options: OptionsText = "{}",
    identity: OptionsText = "{}",
) -> None:
    """Simulate many samples under one load; mesh some of their surfaces anew and compare.

    Example: `tetgan simulate-samples results/samples/table/tetgan-LR/0/solid study.csv
    --options '{samples: 50, remeshed: 5}'`
    """
    from tetgan.mechanics.options import SimulationOptions
    from tetgan.mechanics.study import simulate_samples

    chosen = read_options(SimulationOptions, options, "--options")
    simulate_samples(samples, out, chosen, read_plain(identity, "--identity"))


@app.command(rich_help_panel=PANEL)
def tabulate_simulation(
    studies: Annotated[list[Path], typer.Argument(help="Tables written by `tetgan simulate-samples`.")],
    out: Annotated[Path, typer.Argument(help="Table (.csv) to write; with a .md twin.")],
) -> None:
    """Set the simulation studies side by side, one row per model and mode.

    Example: `tetgan tabulate-simulation studies/*.csv simulation.csv`
    """
    from tetgan.mechanics.table import tabulate_simulation

    tabulate_simulation(studies, out)
