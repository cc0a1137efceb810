"""A folder of meshes from any system, some of them perhaps broken."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.evaluation.surfaces import Surface
from tetgan.shapes.adaptors.directory import walk_meshes
from tetgan.shapes.loading import parse_mesh, read_file
from tetgan.shapes.normalise import normalise
from tetgan.shapes.soup import ShapeError, Soup, clean_soup


class MeshFolder:
    """Every .obj, .off, .ply, .stl and .glb below a folder, named by its path without the suffix.

    Attributes:
        files: name to file.
        problems: file to the reason why it is not used; grows as meshes are read.
    """

    def __init__(self, root: Path, fit: bool) -> None:
        """List the files; `fit` moves and scales each mesh into the unit cube as it is read.

        Raises:
            UserError: no such folder, or no mesh in it.
        """
        if not root.is_dir():
            raise UserError(f"{root}: no such folder")
        self._fit = fit
        self.root = root
        self.files: dict[str, Path] = {}
        self.problems: dict[str, str] = {}
        for path in walk_meshes(root):
            name = path.relative_to(root).with_suffix("").as_posix()
            if name in self.files:
                self.problems[str(path)] = f"{self.files[name].name} has the same name"
            else:
                self.files[name] = path
        if not self.files:
            raise UserError(f"{root}: no mesh (.obj .off .ply .stl .glb) below this folder")

    def surfaces(self, names: Sequence[str]) -> Iterator[tuple[str, Surface]]:
        """Name and surface of those meshes that can be used."""
        shown = track(names, f"meshes of {self.root.name}", console=Console(stderr=True), transient=True)
        found = ((name, self.surface(name)) for name in shown)
        return ((name, surface) for name, surface in found if surface is not None)

    def count(self) -> dict[str, int]:
        """Files found, and those of them that have turned out to be unusable."""
        listed = {str(path) for path in self.files.values()} | set(self.problems)
        return {"files": len(listed), "unusable": len(self.problems)}

    def first_problem(self) -> str:
        """One of the reasons, to end an error message with."""
        return "".join(f"; {Path(path).name}: {why}" for path, why in [*self.problems.items()][:1])

    def surface(self, name: str) -> Surface | None:
        """The triangles of a mesh that have an area, vertices at one position being one; None if unusable.

        Files that store each triangle by itself (.stl), or split vertices where textures do, share edges
        that way.
        """
        path = self.files[name]
        try:
            soup = clean_soup(parse_mesh(read_file(path), path.suffix.lower()))
        except ShapeError as error:
            self.problems[str(path)] = str(error)
            return None
        return _join(soup, normalise(soup.vertices, 0.0) if self._fit else soup.vertices)


def _join(soup: Soup, vertices: np.ndarray) -> Surface:
    positions, place = np.unique(vertices, axis=0, return_inverse=True)
    return Surface(positions, place.reshape(-1)[soup.faces])
