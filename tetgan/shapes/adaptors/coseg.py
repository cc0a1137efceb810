"""COSEG (Wang et al. 2012): a folder a category, such as `Vases/` or `Large-Vases/`, and `shapes/` in it."""

from collections.abc import Iterator

from tetgan.shapes.adaptors.directory import walk_meshes
from tetgan.shapes.options import CosegSource


def list_places(source: CosegSource, category: str) -> Iterator[tuple[str, str, None]]:
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
