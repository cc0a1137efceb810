"""Stage: latent arithmetic A - B + C, which adds to C the part that A has and B lacks."""

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import igl
import numpy as np
import pandas as pd
import torch
from jaxtyping import Bool, Float

from tetgan.errors import UserError
from tetgan.fields.field import Field, VertexField
from tetgan.fields.store import FieldStore
from tetgan.files import whole_file
from tetgan.geometry.triangles import TriangleMesh
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.samples import write_solids
from tetgan.models.files import load_generator
from tetgan.models.iou import occupancy_iou
from tetgan.solids.reading import read_surface
from tetgan.studies.latent.choosing import MOST_SHAPES, Difference, Triple, choose_triples, difference
from tetgan.studies.latent.paths import LatentSpace, add_difference
from tetgan.studies.options import LatentOptions


def changed_faces(
    surface: TriangleMesh, other: TriangleMesh | None, threshold: float
) -> Bool[np.ndarray, "F"]:
    """Faces whose centres lie further than `threshold` from the other surface; all, if there is none."""
    if other is None:
        return np.ones(len(surface.faces), dtype=bool)
    centres = surface.vertices[surface.faces].mean(axis=1)
    squared, _, _ = igl.point_mesh_squared_distance(centres, other.vertices, other.faces)
    return np.sqrt(squared) > threshold


log = logging.getLogger(__name__)

LETTERS = ("A", "B", "C", "D")

TRIPLES, CHANGES = "triples.csv", "changes.npz"


# Each shape of the sum, and the one beside which it is coloured: A has a part that B has not, and so on.
_BESIDE = {"A": "B", "B": "A", "C": "D", "D": "C"}


def add_parts(
    model: Path,
    index: Path,
    folder: Path,
    *,
    options: LatentOptions,
    meshing: MeshingOptions,
    triples: Sequence[tuple[str, str, str]] = (),
) -> None:
    """Decode A, B, C and D = A - B + C for triples of shapes, and tell where they differ.

    Args:
        model: folder of a trained model.
        index: of the fields it was trained on.
        folder: receives `{a}-minus-{b}-plus-{c}/{A,B,C,D}.{ply,vtu}`, smoothed, with `changes.npz` beside
            them (which faces of A, B, C, D are away from B, A, D, C), and `triples.csv`, one row per triple.
            Its `part_in_c` and `part_in_d` are the shares of the tets by which A and B differ that C and D
            have as A does, `kept_of_c` how well C and D agree elsewhere (intersection over union).
        triples: ids; by default chosen from the validation shapes by `choose_triples`.

    Raises:
        UserError: a shape or the model does not exist, or there are no three validation shapes.
    """
    store = FieldStore.open(index)
    space = LatentSpace(load_generator(model, store.hierarchy), store)
    chosen = [Triple(*ids) for ids in triples] or _choose(store, options)
    if not chosen and options.triples:
        raise UserError(f"{index}: no three validation shapes for A - B + C; name a triple")
    rows = [_write_triple(space, triple, folder, options, meshing) for triple in chosen]
    with whole_file(folder / TRIPLES) as partial:
        pd.DataFrame(rows).to_csv(partial, index=False)


def _choose(store: FieldStore, options: LatentOptions) -> list[Triple]:
    ids = store.ids("validation")[:MOST_SHAPES]
    fields = {shape_id: store.read(shape_id) for shape_id in ids}
    return choose_triples(fields, store.hierarchy.finest, options.triples, options.changed)


def _write_triple(
    space: LatentSpace, triple: Triple, folder: Path, options: LatentOptions, meshing: MeshingOptions
) -> dict[str, Any]:
    store, ids = space.store, triple[:3]
    a, b, c = space.encode(ids)
    fields = dict(zip(LETTERS, space.decode(torch.stack([a, b, c, add_difference(a, b, c)])), strict=True))
    into = folder / "{}-minus-{}-plus-{}".format(*ids)
    grid = store.hierarchy.finest
    items: list[tuple[str, Field | VertexField, dict[str, Any]]] = [(x, fields[x], {}) for x in LETTERS]
    written = write_solids(into, items, grid, store.mu, meshing, smoothing=True)
    _write_changes(into, options.changed)
    parts = difference(store.read(triple.a), store.read(triple.b), grid, options.changed)
    log.info("%s", into.name)
    return {
        "triple": into.name,
        **triple._asdict(),
        **_success(fields, parts, grid.volumes),
        **{f"{row['id']}_{name}": row[name] for row in written for name in ("faces", "volume", "components")},
    }


def _success(
    fields: dict[str, Field | VertexField], parts: Difference, volumes: Float[np.ndarray, "T"]
) -> dict[str, float]:
    """How far D went from C to A in the part, and how much of C it kept elsewhere."""
    c, d = fields["C"].occupancy, fields["D"].occupancy
    return {
        "part_in_c": _as_in_a(c, parts, volumes),
        "part_in_d": _as_in_a(d, parts, volumes),
        "kept_of_c": float(occupancy_iou(c[~parts.box], d[~parts.box])),
    }


def _as_in_a(occupancy: Bool[np.ndarray, "T"], parts: Difference, volumes: Float[np.ndarray, "T"]) -> float:
    """Share of the differing tets that are as in A: there if A has them, not there if only B has them."""
    differing = parts.added | parts.removed
    if not differing.any():
        return float("nan")
    return float(volumes[differing & (occupancy == parts.added)].sum() / volumes[differing].sum())


def _write_changes(folder: Path, threshold: float) -> None:
    """Masks over the faces of the surfaces beside it."""
    surfaces = {letter: read_surface(folder / f"{letter}.ply") for letter in LETTERS}
    changes = {
        letter: changed_faces(surface, surfaces[_BESIDE[letter]], threshold)
        for letter, surface in surfaces.items()
        if surface is not None
    }
    with whole_file(folder / CHANGES) as partial:
        np.savez_compressed(partial, **changes)  # type: ignore[arg-type]
