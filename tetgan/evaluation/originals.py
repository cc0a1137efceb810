"""Repaired meshes of a category, read from its shards."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float
from rich.console import Console
from rich.progress import track

from tetgan.evaluation.options import EvaluationOptions
from tetgan.evaluation.seeds import named_seed
from tetgan.evaluation.surfaces import draw_sample
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.archive import read_meshes
from tetgan.shapes.catalogue import read_catalogue


def repaired_meshes(meshes: Sequence[Path]) -> Iterator[tuple[str, TriangleMesh]]:
    """Id and surface of every mesh of the shards."""
    for path in track(meshes, "repaired meshes", console=Console(stderr=True), transient=True):
        for shape_id, vertices, faces in read_meshes(path):
            yield shape_id, TriangleMesh(vertices, faces)


def read_splits(catalogue: Path) -> dict[str, str]:
    """Split of every shape that has a repaired mesh."""
    table = read_catalogue(catalogue)
    table = table[table["status"].isin(["ok", "filled"])]
    return dict(zip(table["id"], table["split"], strict=True))


def training_cloud(
    shape_id: str, surface: TriangleMesh, options: EvaluationOptions
) -> Float[np.ndarray, "P 3"]:
    """Points of a training mesh, as many as sets are compared by."""
    seed = named_seed(options.seed, "training", shape_id)
    return draw_sample(surface, options.sets.points, seed).points


def training_clouds(
    meshes: Sequence[Path], splits: Mapping[str, str], options: EvaluationOptions
) -> Float[np.ndarray, "N P 3"]:
    """Those of every training mesh, in the order of the shards."""
    clouds = [
        training_cloud(shape_id, surface, options)
        for shape_id, surface in repaired_meshes(meshes)
        if splits.get(shape_id) == "train"
    ]
    return np.stack(clouds) if clouds else np.zeros((0, options.sets.points, 3))
