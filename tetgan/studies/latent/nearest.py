"""Stage: the training shape nearest to each sample."""

from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import pandas as pd
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.evaluation.chamfer import SurfaceSample
from tetgan.evaluation.novelty import find_nearest
from tetgan.evaluation.seeds import named_seed
from tetgan.evaluation.surfaces import draw_sample
from tetgan.files import whole_file
from tetgan.geometry.triangles import TriangleMesh
from tetgan.progress import map_threads
from tetgan.shapes.archive import read_meshes
from tetgan.shapes.catalogue import read_catalogue
from tetgan.shapes.loading import MESH_SUFFIXES
from tetgan.solids.folder import finished_samples
from tetgan.solids.reading import read_surface
from tetgan.studies.options import NearestOptions


def find_nearest_shapes(
    meshes: Sequence[Path],
    catalogue: Path,
    out: Path,
    *,
    samples: Path | None,
    options: NearestOptions,
    threads: int = 1,
) -> None:
    """Find the training shape nearest to every sample by Chamfer distance.

    Args:
        meshes, catalogue: shards of repaired meshes, and the catalogue that splits them.
        out: CSV to write: `id`, `nearest` (id of the training shape) and `chamfer`; the last two are empty
            for a sample without a surface.
        samples: folder of meshes, or of a model's samples; without one, the validation shapes are looked
            up, which tells how near a real new shape is.
        threads: KD-tree queries side by side.

    Raises:
        UserError: no samples, or no training shape in the shards.
    """
    wanted = None if samples is None else _meshes_of(samples)
    table = read_catalogue(catalogue)
    split = dict(zip(table["id"], table["split"], strict=True))
    training = {
        shape_id: shape
        for shape_id, shape in _sampled(_real(meshes, split, "train"), "training", options).items()
        if shape is not None
    }
    if not training:
        raise UserError(f"{catalogue}: no training shape is in the meshes; give all shards of the category")
    shapes = _sampled(wanted or _real(meshes, split, "validation"), "looked up", options, options.samples)
    ids, candidates = list(training), list(training.values())
    found = map_threads(
        lambda shape: find_nearest(shape, candidates), list(shapes.values()), threads, "nearest"
    )
    rows = [
        (shape_id, "" if row is None else ids[row], distance)
        for shape_id, (row, distance) in zip(shapes, found, strict=True)
    ]
    with whole_file(out) as partial:
        pd.DataFrame(rows, columns=["id", "nearest", "chamfer"]).to_csv(partial, index=False)


def _real(
    meshes: Sequence[Path], split: dict[str, str], name: str
) -> Iterator[tuple[str, TriangleMesh | None]]:
    """Repaired meshes of a split."""
    for path in meshes:
        for shape_id, vertices, faces in read_meshes(path):
            if split.get(shape_id) == name:
                yield shape_id, TriangleMesh(vertices, faces)


def _meshes_of(folder: Path) -> Iterator[tuple[str, TriangleMesh | None]]:
    """The surfaces of a folder by name, None for an empty one; read as they are asked for.

    Raises:
        UserError: no meshes.
    """
    generated = finished_samples(folder) / "generated"
    where = generated if generated.is_dir() else folder
    paths = sorted(path for path in where.glob("*") if path.suffix.lower() in MESH_SUFFIXES)
    if not paths:
        raise UserError(f"{where}: no meshes ({', '.join(sorted(MESH_SUFFIXES))}) in this folder")
    return ((path.stem, read_surface(path)) for path in paths)


def _sampled(
    surfaces: Iterator[tuple[str, TriangleMesh | None]],
    label: str,
    options: NearestOptions,
    most: int | None = None,
) -> dict[str, SurfaceSample | None]:
    """Points on each of the first surfaces. The label keeps equal ids from drawing equal points."""
    progress = track(islice(surfaces, most), label, console=Console(stderr=True), transient=True)
    return {
        shape_id: None
        if surface is None
        else draw_sample(surface, options.points, named_seed(options.seed, label, shape_id))
        for shape_id, surface in progress
    }
