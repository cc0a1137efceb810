"""Meshes of a category below a root folder: any folder, ShapeNet, COSEG, ModelNet."""

import csv
import os
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path

from tetgan.errors import UserError
from tetgan.shapes.loading import MESH_SUFFIXES
from tetgan.shapes.options import CosegSource, DirectorySource, ModelNetSource, ShapeNetSource


def list_directory(source: DirectorySource, category: str) -> Iterator[tuple[str, str, None]]:
    """Every mesh below the root whose relative path matches `include`; the folder is the category."""
    for path in walk_meshes(source.path):
        relative = path.relative_to(source.path)
        if fnmatchcase(relative.as_posix(), source.include):
            yield relative.with_suffix("").as_posix(), relative.as_posix(), None


def walk_meshes(root: Path) -> Iterator[Path]:
    """Mesh files at any depth, hidden ones apart; linked folders are not followed, so a loop is no trap."""
    for folder, subfolders, files in os.walk(root):
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        for name in sorted(files):
            path = Path(folder, name)
            if path.suffix.lower() in MESH_SUFFIXES and not name.startswith("."):
                yield path


def list_coseg(source: CosegSource, category: str) -> Iterator[tuple[str, str, None]]:
    """Meshes below every folder that has the category in its name; only those in `shapes/` where it exists.

    Ground-truth labels lie beside `shapes/` and may hold meshes too.
    """
    for folder in sorted(source.path.glob("*/")):
        if category not in folder.name.lower():
            continue
        shapes = folder / "shapes"
        for path in walk_meshes(shapes if shapes.is_dir() else folder):
            relative = path.relative_to(source.path)
            yield f"{folder.name}-{path.stem}", relative.as_posix(), None


_FOLDERS = {"train": "train", "test": "validation"}


def list_modelnet(source: ModelNetSource, category: str) -> Iterator[tuple[str, str, str]]:
    """<category>/{train,test}/*.off with its split."""
    for folder, split in _FOLDERS.items():
        for path in walk_meshes(source.path / category / folder):
            yield path.stem, path.relative_to(source.path).as_posix(), split


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


def list_shapenet(source: ShapeNetSource, category: str) -> Iterator[tuple[str, str, str | None]]:
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
