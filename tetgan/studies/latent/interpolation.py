"""Stage: interpolation between pairs of shapes."""

import logging
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from torch import Tensor

from tetgan.errors import UserError
from tetgan.evaluation.chamfer import SurfaceSample, chamfer
from tetgan.evaluation.seeds import named_seed
from tetgan.evaluation.surfaces import draw_sample
from tetgan.fields.field import Field, VertexField
from tetgan.fields.store import FieldStore
from tetgan.files import whole_file
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.samples import write_solids
from tetgan.models.files import load_generator
from tetgan.solids.reading import read_surface
from tetgan.studies.latent.choosing import choose_pairs
from tetgan.studies.latent.paths import LatentSpace, interpolate
from tetgan.studies.options import LatentOptions

log = logging.getLogger(__name__)

STEPS = "steps.csv"


def interpolate_shapes(
    model: Path,
    index: Path,
    folder: Path,
    *,
    options: LatentOptions,
    meshing: MeshingOptions,
    pairs: Sequence[tuple[str, str]] = (),
) -> None:
    """Interpolate between the latents of pairs of shapes, and mesh every step.

    Args:
        model: folder of a trained model.
        index: of the fields it was trained on.
        folder: receives `{first}-to-{second}/{step}.{ply,vtu}`, smoothed, and `steps.csv`: per step
            `t`, the Chamfer distances `chamfer_step` to the step before, `chamfer_first` and `chamfer_second`
            to both ends, and the quality of the mesh. Where a step is empty, so are its distances.
        pairs: ids; by default drawn from the validation shapes.

    Raises:
        UserError: a shape or the model does not exist, or there are no two validation shapes.
    """
    store = FieldStore.open(index)
    space = LatentSpace(load_generator(model, store.hierarchy), store)
    pairs = pairs or choose_pairs(store.ids("validation"), options.pairs, options.seed)
    if not pairs and options.pairs:
        raise UserError(f"{index}: no two validation shapes to interpolate between; name a pair")
    rows = []
    for first, second in pairs:
        ends = space.encode([first, second])
        latents = interpolate(ends[0], ends[1], options.steps, options.path)
        into = folder / f"{first}-to-{second}"
        columns = {"pair": into.name, "first": first, "second": second}
        fields = _numbered(space, latents, columns)
        grid = store.hierarchy.finest
        written = write_solids(into, fields, grid, store.mu, meshing, smoothing=True)
        rows += _with_distances(into, written, options)
        log.info("%s: %d steps", into.name, len(written))
    with whole_file(folder / STEPS) as partial:
        pd.DataFrame(rows).to_csv(partial, index=False)


def _numbered(
    space: LatentSpace, latents: Tensor, columns: Mapping[str, Any]
) -> Iterator[tuple[str, Field | VertexField, dict[str, Any]]]:
    for step, field in enumerate(space.decode(latents)):
        yield f"{step:02d}", field, {**columns, "t": step / (len(latents) - 1)}


def _with_distances(
    folder: Path, rows: Sequence[Mapping[str, Any]], options: LatentOptions
) -> list[dict[str, Any]]:
    """Rows with the Chamfer distance of each step to the one before and to both ends."""
    samples = [_sample(folder / f"{row['id']}.ply", options) for row in rows]
    before = [None, *samples[:-1]]
    return [
        {
            **row,
            "chamfer_step": _distance(sample, previous),
            "chamfer_first": _distance(sample, samples[0]),
            "chamfer_second": _distance(sample, samples[-1]),
        }
        for row, sample, previous in zip(rows, samples, before, strict=True)
    ]


def _sample(path: Path, options: LatentOptions) -> SurfaceSample | None:
    surface = read_surface(path)
    if surface is None:
        return None
    return draw_sample(surface, options.points, named_seed(options.seed, path.parent.name, path.stem))


def _distance(first: SurfaceSample | None, second: SurfaceSample | None) -> float:
    return math.nan if first is None or second is None else chamfer(first, second)
