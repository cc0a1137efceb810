"""Stage: repaired meshes of a shard to fields on a grid."""

from pathlib import Path

from rich.console import Console
from rich.progress import track

from tetgan.fields.extract import extract_field
from tetgan.fields.shard import write_shard
from tetgan.grids.build import grid_from_options
from tetgan.grids.options import GridOptions
from tetgan.shapes.archive import read_meshes


def extract_shard(meshes: Path, out: Path, grid: GridOptions) -> None:
    """Extract the field of every mesh in an archive; one mesh is in memory at a time.

    Raises:
        UserError: the archive or the grid file cannot be read.
    """
    hierarchy = grid_from_options(grid)
    ids = [shape_id for shape_id, _, _ in read_meshes(meshes)]
    progress = track(read_meshes(meshes), description="fields", total=len(ids), console=Console(stderr=True))
    fields = (extract_field(vertices, faces, hierarchy.finest) for _, vertices, faces in progress)
    write_shard(out, ids, fields, hierarchy.digest)
