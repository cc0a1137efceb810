"""Generated solids packed into the page: whole tet meshes with the quality of each tet."""

import base64
import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int, UInt8

from tetgan.errors import UserError
from tetgan.geometry.tets import dihedral_angles, radius_ratios, tet_volumes
from tetgan.solids.folder import read_certificates
from tetgan.solids.reading import read_tets

BUDGET = 6_000_000
"""Characters of all packed solids together."""

REGULAR_DIHEDRAL = float(np.degrees(np.arccos(1 / 3)))
"""Degrees: the most that the smallest dihedral angle of a tet can be."""

_INVERTED = 255  # code of a tet of no or negative volume; a quality has the codes below

_LEVELS = 254

_STEPS = 65535

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class SampleSet:
    """Solids that one model generated, in the order of their ids."""

    category: str
    model: str
    seed: int
    mode: str
    smoothing: str
    paths: tuple[Path, ...]

    @property
    def validity(self) -> str:
        """Number of valid ones among all solids it generated, by their certificate; empty without one."""
        try:
            table = read_certificates(self.paths[0].parent.parent)
            if table is None:
                return ""
            made = table[(table["set"] == "generated") & (table["tets"] > 0)]
            return f"{int(made['valid'].sum())} of {len(made)} valid"
        except (UserError, KeyError):  # a damaged one, or one of surfaces
            return ""


def find_sample_sets(samples: Path, models: Sequence[str], count: int) -> list[SampleSet]:
    """The first `count` solids of each category, model and mode: not the best ones.

    Args:
        samples: folder of `{category}/{model}/{seed}/{mode}/{smoothing}/generated/{id}.vtu`; of several seeds
            the lowest is taken, of several smoothings `wls`.
        models: their order; empty for every model that has solids.

    Raises:
        UserError: a model that is asked for has no solids.
    """
    found = [found for mode in sorted(samples.glob("*/*/*/*")) if (found := _sample_set(mode, count))]
    lowest: dict[tuple[str, str, str], SampleSet] = {}
    for one in sorted(found, key=lambda one: one.seed):
        lowest.setdefault((one.category, one.model, one.mode), one)
    names = list(models) or sorted({model for _, model, _ in lowest})
    for name in names:
        if not any(name == model for _, model, _ in lowest):
            raise UserError(f"{samples}: no solids (.vtu) of model '{name}' to show; sample it first")
    shown = [one for one in lowest.values() if one.model in names]
    # Valid solids first: they are what the page is opened for.
    return sorted(shown, key=lambda one: (one.category, names.index(one.model), one.mode != "solid"))


def _sample_set(mode: Path, count: int) -> SampleSet | None:
    """Solids of one folder that `tetgan sample` wrote; None when there are none."""
    category, model, seed, name = mode.parts[-4:]
    for smoothing in ("wls", "none"):
        paths = sorted((mode / smoothing / "generated").glob("*.vtu"))
        if paths and seed.isdigit() and not name.startswith("."):  # a dot: still being written
            return SampleSet(category, model, int(seed), name, smoothing, tuple(paths[:count]))
    return None


def pack_sets(sets: Sequence[SampleSet], budget: int = BUDGET) -> list[dict[str, Any]]:
    """The sets as plain values for the page's viewer.

    Solids are taken in turn from each set until the budget is spent, so that every set has one before any
    has two. What does not fit is left out, with a warning.
    """
    packed: list[list[dict[str, Any]]] = [[] for _ in sets]
    left, missed = budget, 0
    for number, path in _in_turn(sets):
        solid = {"id": path.stem, **pack_solid(*read_tets(path))}
        size = sum(len(value) for value in solid.values() if isinstance(value, str))
        if size > left:
            missed += 1
        else:
            left -= size
            packed[number].append(solid)
    if missed:
        log.warning("%d solids left out, or the page would grow too large", missed)
    return [
        {
            "category": one.category,
            "model": one.model,
            "seed": one.seed,
            "mode": one.mode,
            "smoothing": one.smoothing,
            "validity": one.validity,
            "solids": solids,
        }
        for one, solids in zip(sets, packed, strict=True)
        if solids
    ]


def _in_turn(sets: Sequence[SampleSet]) -> Iterator[tuple[int, Path]]:
    for rank in zip_longest(*(one.paths for one in sets)):
        yield from ((number, path) for number, path in enumerate(rank) if path)


def pack_solid(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> dict[str, Any]:
    """A solid as plain values and base64 of little-endian arrays.

    Returns:
        `low` and `step`: a vertex lies at low + step * code, off by at most step / 2 along each axis, where
        step is the longest side of the bounding box over 65535; `positions`, codes (V, 3) uint16; `tets`
        (T, 4) uint16, or uint32 where `wide`; `dihedral` and `ratio` (T,) uint8, 255 for an inverted tet and
        otherwise 254ths of 70.53 degrees (smallest dihedral angle) and of 1 (radius ratio); `vertices`,
        `count`, `inverted` and `smallest`, the figures to show, `smallest` in degrees over tets that are not
        inverted.

    Raises:
        ValueError: there are no tets.
    """
    if len(tets) == 0:
        raise ValueError("a solid without tets")
    used, compact = np.unique(tets, return_inverse=True)
    points = vertices[used]
    low = points.min(axis=0)
    step = float((points.max(axis=0) - low).max() / _STEPS) or 1.0
    upright = tet_volumes(vertices, tets) > 0
    angles = dihedral_angles(vertices, tets).min(axis=1)
    wide = len(used) > _STEPS + 1
    return {
        "low": low.tolist(),
        "step": step,
        "positions": _base64(np.rint((points - low) / step), "<u2"),
        "tets": _base64(compact.reshape(-1, 4), "<u4" if wide else "<u2"),
        "wide": wide,
        "dihedral": _base64(_codes(angles / REGULAR_DIHEDRAL, upright), "u1"),
        "ratio": _base64(_codes(radius_ratios(vertices, tets), upright), "u1"),
        "vertices": len(used),
        "count": len(tets),
        "inverted": int((~upright).sum()),
        "smallest": round(float(angles[upright].min()), 2) if upright.any() else None,
    }


def _codes(quality: Float[np.ndarray, "T"], upright: np.ndarray) -> UInt8[np.ndarray, "T"]:
    codes = np.rint(np.clip(quality, 0, 1) * _LEVELS).astype(np.uint8)
    return np.where(upright, codes, np.uint8(_INVERTED))


def _base64(array: np.ndarray, kind: str) -> str:
    return base64.b64encode(array.astype(kind).tobytes()).decode()
