"""Any folder of meshes, nested or not."""

import os
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path

from tetgan.shapes.loading import MESH_SUFFIXES
from tetgan.shapes.options import DirectorySource


def list_places(source: DirectorySource, category: str) -> Iterator[tuple[str, str, None]]:
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
