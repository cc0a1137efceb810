"""Study of samples under one load: share simulated, displacements, and those of remeshed bodies."""

import logging
import time
from collections.abc import Iterator, Mapping
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from jaxtyping import Float
from rich.console import Console
from rich.progress import track
from scipy.spatial import Delaunay, QhullError

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.geometry.tets import TetMesh, orientations, tet_volumes
from tetgan.mechanics.errors import UnfitError
from tetgan.mechanics.options import LoadCase, SimulationOptions
from tetgan.mechanics.pieces import label_pieces, largest_piece, share_left_out
from tetgan.mechanics.remesh import RemeshWorker, can_remesh
from tetgan.mechanics.simulation import Simulation, simulate
from tetgan.shapes.cleaning import ShapeError
from tetgan.solids.folder import finished_samples, sample_ids
from tetgan.solids.reading import read_solid

log = logging.getLogger(__name__)

EMPTY = "nothing in it"
"""Why a sample without a mesh fails."""

_MOST_REFINED = 2000  # tets of a body that is simulated cut into eight too: for more it takes minutes

_KEPT = ("tets", "unknowns", "iterations", "residual", "peak_displacement", "stress_p99", "work", "imbalance")


class Shown(NamedTuple):
    """A sample, whether all of it was simulated or its largest piece, and whether that stands."""

    sample: str
    result: Simulation
    whole: bool
    standing: bool


def simulate_samples(
    samples: Path, out: Path, options: SimulationOptions, identity: Mapping[str, Any]
) -> None:
    """Simulate the samples of a model and write a row for each.

    Of a sample in several pieces the largest is simulated. `reason` tells why a sample fails. Of the samples
    whose surface is meshed anew, `difference` is that of the largest displacement to the one found so, as a
    share of the latter, and `refined_difference` the same with the sample's own tets cut into eight, of
    samples of up to 2,000 tets.

    Args:
        samples: folder written by `tetgan sample`; those with smoothing are taken, if there are any.
        out: `.csv`.
        identity: columns in front of each row.
    """
    folder = finished_samples(samples)
    ids = sample_ids(folder, "generated", options.samples)
    left = options.remeshed
    if left and not can_remesh():
        log.warning("no sample is remeshed: pytetwild is not installed (pip install 'tetgan[remesh]')")
        left = 0
    rows = []
    with RemeshWorker(options.remeshing) if left else nullcontext() as worker:
        for name in track(ids, "simulating", console=Console(stderr=True), transient=True):
            row, solid = _simulate_one(folder, name, options.case)
            if worker is not None and left and solid is not None:
                row |= _remesh_one(worker, solid, options.case, float(row["peak_displacement"]))
                left -= 1
            rows.append({**identity, "smoothing": folder.name, "id": name, **row})
    if not rows:
        raise UserError(f"{folder}: no generated samples; run 'tetgan sample' first")
    with whole_file(out) as partial:
        pd.DataFrame(rows).to_csv(partial, index=False)


def first_standing(samples: Path, case: LoadCase) -> Shown:
    """The first sample that is one piece of valid tets and stands.

    Where there is none, the first whose largest piece stands; and where there is none of these either, the
    first that can be simulated.

    Raises:
        UserError: no sample can be simulated.
    """
    folder = finished_samples(samples)
    fallback: Shown | None = None
    for name, piece, left_out in _pieces_in_order(folder):
        try:
            result = replace(simulate(piece, case), left_out=left_out)
        except UnfitError:
            continue
        found = Shown(name, result, left_out == 0, is_standing(result))
        if found.standing:
            return found
        fallback = fallback or found
    if fallback is None:
        raise UserError(f"{folder}: none of its samples can be simulated")
    return fallback


def _pieces_in_order(folder: Path) -> Iterator[tuple[str, TetMesh, float]]:
    """Largest pieces of valid tets, and the share of each sample left out: first those that are all of it."""
    parts: list[tuple[str, TetMesh, float]] = []
    for name in sample_ids(folder, "generated"):
        path = folder / "generated" / f"{name}.vtu"
        if not path.is_file():
            continue
        solid = read_solid(path)
        try:
            piece = largest_piece(solid)
        except UnfitError:
            continue
        if (orientations(piece.vertices, piece.tets) <= 0).any():
            continue
        if len(piece.tets) == len(solid.tets):
            yield name, piece, 0.0
        else:
            parts.append((name, piece, share_left_out(solid, piece)))
    yield from parts


def is_standing(result: Simulation) -> bool:
    """Whether a body would not tip over: its centre of mass is above the hull of its feet."""
    volumes = tet_volumes(result.vertices, result.tets)
    middle = np.average(result.vertices[result.tets].mean(axis=1), axis=0, weights=volumes)
    return _in_hull(middle[[0, 2]], result.feet[:, [0, 2]])


def _in_hull(point: Float[np.ndarray, "2"], points: Float[np.ndarray, "P 2"]) -> bool:
    try:
        return bool(Delaunay(points).find_simplex(point) >= 0)
    except (QhullError, ValueError):  # fewer than three points, or all on one line
        return False


def _simulate_one(folder: Path, name: str, case: LoadCase) -> tuple[dict[str, Any], TetMesh | None]:
    """The row of one sample, and what was simulated of it."""
    path = folder / "generated" / f"{name}.vtu"
    if not path.is_file():
        return {"reason": EMPTY}, None
    solid = read_solid(path)
    start = time.perf_counter()
    try:
        pieces = int(label_pieces(solid.tets).max()) + 1
        piece = largest_piece(solid)
        row = {"pieces": pieces, "share": len(piece.tets) / len(solid.tets)}
        result = simulate(piece, case)
    except UnfitError as error:
        log.info("%s: %s", path, error)
        return {"reason": error.kind}, None
    record = result.record()
    row |= {"seconds": time.perf_counter() - start, "standing": is_standing(result)}
    return {"reason": "", **row, **{key: record[key] for key in _KEPT}}, piece


def _remesh_one(worker: RemeshWorker, solid: TetMesh, case: LoadCase, peak: float) -> dict[str, Any]:
    """The same shape through other tets: how much further or less far it bends."""
    finer = case.model_copy(update={"refine": case.refine + 1})
    try:
        refined = _peak(solid, finer) if len(solid.tets) <= _MOST_REFINED else np.nan
        other = largest_piece(worker.remesh(solid))
        again = _peak(other, case, surface=solid)
    except (ShapeError, UnfitError) as error:
        log.warning("remeshed: %s", error)
        return {"remesh_reason": str(error)}
    return {
        "remesh_reason": "",
        "refined_displacement": refined,
        "remeshed_tets": len(other.tets),
        "remeshed_displacement": again,
        "difference": peak / again - 1,
        "refined_difference": refined / again - 1,
    }


def _peak(solid: TetMesh, case: LoadCase, surface: TetMesh | None = None) -> float:
    return float(simulate(solid, case, surface=surface).record()["peak_displacement"])
