"""ShapeNetCore (Chang et al. 2015), versions 1 and 2."""

import csv
from collections.abc import Iterator
from pathlib import Path

from tetgan.errors import UserError
from tetgan.shapes.options import ShapeNetSource

SYNSETS = {
    "chair": "03001627",
    "sofa": "04256520",
    "bench": "02828884",
    "table": "04379243",
    "car": "02958343",
    "vase": "03593526",  # jar: ShapeNetCore has no synset of vases, it files them here
}
_MESHES = ("models/model_normalized.obj", "model.obj")  # version 2, version 1
# One validation set here, so what the official split keeps from training is all in it.
_SPLITS = {"train": "train", "val": "validation", "test": "validation"}


def list_places(source: ShapeNetSource, category: str) -> Iterator[tuple[str, str, str | None]]:
    """<synset>/<model>/ with either version's mesh inside; a model without a mesh is not listed.

    Raises:
        UserError: the category has no synset of its own and none is given.
    """
    synset = source.synset or SYNSETS.get(category)
    if synset is None:
        raise UserError(
            f"sources.{category}: no ShapeNet synset is known for it; set sources.{category}.synset"
        )
    table = source.path / "all.csv"
    splits = _official_split(table, synset) if source.split == "official" and table.is_file() else {}
    for model in sorted((source.path / synset).glob("*/")):
        mesh = next((name for name in _MESHES if (model / name).is_file()), None)
        if mesh is not None:
            yield model.name, f"{synset}/{model.name}/{mesh}", splits.get(model.name)


def _official_split(table: Path, synset: str) -> dict[str, str]:
    """Model id to split, from columns id, synsetId, subSynsetId, modelId, split."""
    with table.open(newline="", encoding="utf-8") as stream:
        rows = csv.DictReader(stream)
        missing = {"synsetId", "modelId", "split"} - set(rows.fieldnames or ())
        if missing:
            raise UserError(f"{table}: column '{min(missing)}' is missing")
        # Spreadsheets drop leading zeros.
        mine = [row for row in rows if (row["synsetId"] or "").zfill(8) == synset]
    return {row["modelId"]: _SPLITS[row["split"]] for row in mine if row["split"] in _SPLITS}
