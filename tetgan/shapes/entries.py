"""Shapes that a source lists, their names, and their split."""

import hashlib
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from tetgan.shapes.options import SplitOptions

_LONGEST_ID = 100


@dataclass(frozen=True, order=True)
class ShapeEntry:
    """One shape of a source.

    `id` is a unique, safe file name; `path` says where the shape is, relative to the source's root;
    `split` is the source's own, None where the seeded split decides.
    """

    id: str
    path: str
    split: str | None = None


def name_entries(places: Iterable[tuple[str, str, str | None]]) -> list[ShapeEntry]:
    """Entries sorted by id from (wished name, path, split).

    A name keeps its letters, digits, dots, dashes and underscores. Names that agree after that, letter case
    apart (some file systems ignore it), or are long, gain a digest of the path; the others stay readable.
    """
    wished = [(_safe_name(name), path, split) for name, path, split in places]
    uses = Counter(name.lower() for name, _, _ in wished)
    entries = [
        ShapeEntry(
            name
            if uses[name.lower()] == 1 and len(name) <= _LONGEST_ID
            else f"{name[:_LONGEST_ID]}-{_digest(path)}",
            path,
            split,
        )
        for name, path, split in wished
    ]
    return sorted(entries)


def draw_entries(entries: Sequence[ShapeEntry], limit: int | None) -> list[ShapeEntry]:
    """At most `limit` entries: those with the smallest digests, so a larger limit only adds shapes."""
    if limit is None or len(entries) <= limit:
        return sorted(entries)
    return sorted(sorted(entries, key=lambda entry: _digest(entry.id, 64))[:limit])


def _safe_name(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9._-]+", "-", name).strip("._-") or "shape"


def _digest(text: str, length: int = 8) -> str:
    return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()[:length]


def assign_splits(entries: Sequence[ShapeEntry], options: SplitOptions) -> dict[str, str]:
    """Id to 'train', 'validation' or 'holdout', for all listed shapes of a category.

    A source's own split is kept. The others are permuted by the seed, and the first of every `validation`
    of them, rounded, validates. What repair makes of a shape plays no part, so every stage agrees.
    """
    splits = {entry.id: entry.split for entry in entries if entry.split is not None}
    free = sorted(entry.id for entry in entries if entry.split is None)
    order = np.random.default_rng(options.seed).permutation(len(free))
    validating = round(len(free) / options.validation)
    splits |= {
        free[position]: "validation" if rank < validating else "train" for rank, position in enumerate(order)
    }
    return splits
