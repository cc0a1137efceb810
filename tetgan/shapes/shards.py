"""Stage: repair every shape of one shard of a category."""

import logging
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.archive import write_meshes
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.entries import ShapeEntry
from tetgan.shapes.isolation import RepairWorker
from tetgan.shapes.normalise import normalise
from tetgan.shapes.options import RepairOptions, SourceOptions
from tetgan.shapes.repair import Repaired, repair_shape
from tetgan.shapes.sources import digest_shape, list_shapes, load_shape

Record = dict[str, Any]

_log = logging.getLogger(__name__)


def repair_shard(
    category: str, source: SourceOptions, repair: RepairOptions, *, margin: float, shard: str, out: Path
) -> None:
    """Write the repaired, normalised meshes of one shard and a record of each listed shape of it.

    A shape that cannot be repaired is a record with its reason. Shapes that are wanted as surfaces only
    (split 'holdout') are recorded and left alone.

    Args:
        category: of the source, such as 'chair'.
        margin: kept free around the shape, a fraction of the unit cube.
        shard: such as '3-of-16'; the shards of one number together hold every shape once.
        out: the zip to write.
    """
    entries = shard_entries(list_shapes(source, category), shard)
    records: list[Record] = []

    def meshes() -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
        with RepairWorker(repair) as worker:
            for entry in track(entries, f"repair {category} {shard}", console=Console(stderr=True)):
                record, repaired = _repair_entry(category, source, repair, entry, worker)
                records.append(record)
                if repaired is not None:
                    placed = TriangleMesh(normalise(repaired.solid.vertices, margin), repaired.solid.faces)
                    record["cube_volume"] = placed.volume
                    yield entry.id, placed.vertices, placed.faces

    write_meshes(out, meshes(), records)


def shard_entries(entries: list[ShapeEntry], shard: str) -> list[ShapeEntry]:
    """Every n-th entry, so that shards are alike.

    Raises:
        UserError: not of the form 'i-of-n' with 1 <= i <= n.
    """
    match = re.fullmatch(r"(\d+)-of-(\d+)", shard)
    if not match or not 1 <= int(match[1]) <= int(match[2]):
        raise UserError(f"shard '{shard}': write it as 3-of-16")
    return entries[int(match[1]) - 1 :: int(match[2])]


def _repair_entry(
    category: str, source: SourceOptions, options: RepairOptions, entry: ShapeEntry, worker: RepairWorker
) -> tuple[Record, Repaired | None]:
    record: Record = {
        "id": entry.id,
        "path": entry.path,
        "sha256": digest_shape(source, category, entry),
        "split": entry.split or "",
    }
    if entry.split == "holdout":
        return record | {"status": "surface", "reason": ""}, None
    started = time.perf_counter()
    try:
        soup = load_shape(source, category, entry)
        record["faces_in"] = len(soup.faces)
        repaired = repair_shape(soup, worker, options)
    # Untrusted geometry meets five libraries here; whatever they raise is this shape's, not the category's.
    except Exception as error:
        reason = str(error) if isinstance(error, ShapeError) else f"{type(error).__name__}: {error}"
        _log.warning("%s rejected: %s", entry.id, reason, exc_info=not isinstance(error, ShapeError))
        return record | {"status": "rejected", "reason": " ".join(reason.split())}, None
    record |= {
        "status": "filled" if repaired.filled_share else "ok",
        "reason": "hollow inside" if repaired.hollow else "",
        "faces_out": len(repaired.solid.faces),
        "volume": repaired.volume,
        "distance": repaired.distance,
        "filled_share": repaired.filled_share,
        "seconds": round(time.perf_counter() - started, 3),
    }
    return record, repaired
