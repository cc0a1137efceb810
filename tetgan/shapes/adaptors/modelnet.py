"""ModelNet10 and ModelNet40 (Wu et al. 2015)."""

from collections.abc import Iterator

from tetgan.shapes.adaptors.directory import walk_meshes
from tetgan.shapes.options import ModelNetSource

_FOLDERS = {"train": "train", "test": "validation"}


def list_places(source: ModelNetSource, category: str) -> Iterator[tuple[str, str, str]]:
    """<category>/{train,test}/*.off with its split."""
    for folder, split in _FOLDERS.items():
        for path in walk_meshes(source.path / category / folder):
            yield path.stem, path.relative_to(source.path).as_posix(), split
