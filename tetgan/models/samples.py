"""Stage: a trained model to folders of meshes."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar

import pandas as pd
from rich.console import Console
from rich.progress import track

from tetgan.fields.samplings import open_sampling
from tetgan.fields.store import FieldStore
from tetgan.files import whole_file
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.samples import write_solids, write_surfaces
from tetgan.models.files import load_generator, load_options, load_surface_model
from tetgan.models.registry import method_of
from tetgan.models.sampling import generate_fields, reconstruct_fields
from tetgan.models.surfaces import extraction_of, generate_surfaces, reconstruct_surfaces
from tetgan.solids.folder import write_certificates

SMOOTHINGS = {"none": False, "wls": True}
"""Folder of each smoothing: without, and with the weighted Laplacian of Eq. 4."""

Row = dict[str, Any]

Shape = TypeVar("Shape")

Item = tuple[str, Shape, Row]


def sample_model(
    model: Path, index: Path, folder: Path, *, count: int, options: MeshingOptions, seed: int
) -> None:
    """Generate `count` shapes and reconstruct the validation shapes, where the model has an encoder.

    Models of fields give surfaces and solids, with and without smoothing; models of implicit surfaces give
    surfaces, without.

    Args:
        model: folder of a trained model.
        index: of the fields, or the sampling, that it was trained on.
        folder: receives `{none,wls}/{generated,reconstructed}/{id}.{ply,vtu}`, `certificate.csv` beside
            them, and `about.json` with the method, the number of tets, if any, and the minutes of training.
    """
    method = method_of(load_options(model))
    if method.sampling is None:
        about = _write_solids(model, index, folder, options, count=count, seed=seed)
    else:
        about = _write_surfaces(model, index, folder, method.sampling["kind"], count=count, seed=seed)
    about |= {"method": method.name, "train_minutes": _train_minutes(model)}
    with whole_file(folder / "about.json") as partial:
        partial.write_text(json.dumps(about, indent=2) + "\n")


def _write_solids(
    model: Path, index: Path, folder: Path, options: MeshingOptions, *, count: int, seed: int
) -> Row:
    """Fields are decoded again for each smoothing, so that one shape is in memory at a time; the seed makes
    them the same."""
    store = FieldStore.open(index)
    generator, ids = load_generator(model, store.hierarchy), store.ids("validation")
    for name, smoothing in SMOOTHINGS.items():
        rows = []
        for kind, shapes in (
            ("generated", _numbered(generate_fields(generator, store, count, seed), count)),
            ("reconstructed", _with_iou(reconstruct_fields(generator, store, ids), len(ids))),
        ):
            into = folder / name / kind
            grid = store.hierarchy.finest
            written = write_solids(into, shapes, grid, store.mu, options, smoothing=smoothing)
            rows += [{"set": kind} | row for row in written]
        write_certificates(folder / name, rows)
    return {"tets": len(store.hierarchy.finest.tets)}


def _write_surfaces(model: Path, index: Path, folder: Path, sampling: str, *, count: int, seed: int) -> Row:
    store = open_sampling(index, sampling)
    trained = load_surface_model(model)
    extraction = extraction_of(trained, store)
    ids = store.ids("validation") if trained.has_encoder else []
    rows = []
    for name, shapes in (
        ("generated", _numbered(generate_surfaces(trained, extraction, count, seed), count)),
        ("reconstructed", _with_iou(reconstruct_surfaces(trained, extraction, store, ids), len(ids))),
    ):
        written = write_surfaces(folder / "none" / name, shapes)
        rows += [{"set": name} | row for row in written]
    write_certificates(folder / "none", rows)
    return {}


def _numbered(shapes: Iterator[Shape], count: int) -> Iterator[Item[Shape]]:
    """Generated shapes by their number."""
    progress = track(shapes, description="sampling", total=count, console=Console(stderr=True))
    for number, shape in enumerate(progress):
        yield f"{number:04d}", shape, {}


def _with_iou(shapes: Iterator[tuple[str, Shape, float]], count: int) -> Iterator[Item[Shape]]:
    """Reconstructions by the id of their original."""
    if not count:
        return
    progress = track(shapes, description="reconstructing", total=count, console=Console(stderr=True))
    for shape_id, shape, iou in progress:
        yield shape_id, shape, {"iou": iou}


def _train_minutes(model: Path) -> float | None:
    """Minutes in the training log; none for models that are not trained step by step."""
    log = model / "log.csv"
    if not log.exists():
        return None
    return round(float(pd.read_csv(log)["seconds"].iloc[-1]) / 60, 2)
