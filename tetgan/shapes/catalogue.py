"""Catalogue of a category: one row per listed shape with its split, status and reason."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.shapes.archive import read_records, read_table
from tetgan.shapes.entries import ShapeEntry, assign_splits
from tetgan.shapes.options import SplitOptions


def gather_catalogue(shards: Sequence[Path], split: SplitOptions, out: Path) -> None:
    """Join the records of all shards, sorted by id, and fill in the split.

    Raises:
        UserError: two shards hold the same shape, or no shape of a category could be repaired.
    """
    table = pd.concat([read_records(path) for path in shards], ignore_index=True).sort_values("id")
    repeated = table["id"][table["id"].duplicated()]
    if len(repeated):
        raise UserError(
            f"{out}: shape '{repeated.iloc[0]}' is in two shards; were they made with one config?"
        )
    if not table["status"].isin(["ok", "filled"]).any():
        reasons = Counter(table["reason"][table["status"] == "rejected"]).most_common(1)
        raise UserError(f"{out}: no shape could be repaired; the commonest reason is '{reasons[0][0]}'")
    columns = (table[name].tolist() for name in ("id", "path", "split"))
    entries = [ShapeEntry(shape_id, path, own or None) for shape_id, path, own in zip(*columns, strict=True)]
    table["split"] = table["id"].map(assign_splits(entries, split))
    with whole_file(out) as partial:
        table.to_csv(partial, index=False)


def read_catalogue(path: Path) -> pd.DataFrame:
    """Columns id, path, sha256, split, status, reason as text, then numbers, empty where there is none.

    `status` is ok, filled (an inside was hollow), rejected (see reason) or surface (hold-out, not repaired).

    Raises:
        UserError: the file is none of `gather_catalogue`.
    """
    try:
        table = read_table(path)
    except ValueError as error:
        raise UserError(
            f"{path}: not a catalogue ({str(error).strip()}); make it with 'tetgan gather-catalogue'"
        ) from None
    missing = [name for name in ("id", "split") if name not in table]
    if missing:
        raise UserError(
            f"{path}: not a catalogue (no column '{missing[0]}'); make it with 'tetgan gather-catalogue'"
        )
    return table
