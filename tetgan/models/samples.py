"""Stage: a trained model to folders of meshes."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd
from rich.console import Console
from rich.progress import track

from tetgan.fields.field import Field, VertexField
from tetgan.fields.store import FieldStore
from tetgan.files import whole_file
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.samples import write_solids
from tetgan.models.generator import FieldGenerator
from tetgan.models.registry import load_generator
from tetgan.models.sampling import generate_fields, reconstruct_fields

SMOOTHINGS = {"none": False, "wls": True}
"""Folder of each smoothing: without, and with the weighted Laplacian of Eq. 4."""

Row = tuple[str, Field | VertexField, dict[str, Any]]


def write_samples(
    model: Path, index: Path, folder: Path, *, count: int, options: MeshingOptions, seed: int
) -> None:
    """Generate `count` shapes and reconstruct the validation shapes, with and without smoothing.

    Fields are decoded again for each smoothing, so that one shape is in memory at a time; the seed makes
    them the same.

    Args:
        model: folder of a trained model.
        folder: receives `{none,wls}/{generated,reconstructed}/{id}.{ply,vtu}`, `certificate.csv` beside
            them, and `about.json` with the number of tets and the minutes of training.
    """
    store = FieldStore.open(index)
    generator = load_generator(model, store.hierarchy)
    for name, smoothing in SMOOTHINGS.items():
        rows = []
        for kind, shapes in (
            ("generated", _generated(generator, store, count, seed)),
            ("reconstructed", _reconstructed(generator, store)),
        ):
            into = folder / name / kind
            grid = store.hierarchy.finest
            written = write_solids(into, shapes, grid, store.mu, options, smoothing=smoothing)
            rows += [{"set": kind} | row for row in written]
        with whole_file(folder / name / "certificate.csv") as partial:
            pd.DataFrame(rows).to_csv(partial, index=False)
    about = {"tets": len(store.hierarchy.finest.tets), "train_minutes": _train_minutes(model)}
    with whole_file(folder / "about.json") as partial:
        partial.write_text(json.dumps(about, indent=2) + "\n")


def _generated(generator: FieldGenerator, store: FieldStore, count: int, seed: int) -> Iterator[Row]:
    shapes = generate_fields(generator, store, count, seed)
    progress = track(shapes, description="sampling", total=count, console=Console(stderr=True))
    for number, field in enumerate(progress):
        yield f"{number:04d}", field, {}


def _reconstructed(generator: FieldGenerator, store: FieldStore) -> Iterator[Row]:
    ids = store.ids("validation")
    shapes = reconstruct_fields(generator, store, ids)
    progress = track(shapes, description="reconstructing", total=len(ids), console=Console(stderr=True))
    for shape_id, field, iou in progress:
        yield shape_id, field, {"iou": iou}


def _train_minutes(model: Path) -> float | None:
    """Minutes in the training log; none for models that are not trained step by step."""
    log = model / "log.csv"
    if not log.exists():
        return None
    return round(float(pd.read_csv(log)["seconds"].iloc[-1]) / 60, 2)
