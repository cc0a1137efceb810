"""A folder of meshes from any system: its surfaces, the broken ones, and its frame."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import ShapeError, clean_mesh
from tetgan.shapes.collections import walk_meshes
from tetgan.shapes.loading import parse_mesh, read_file
from tetgan.shapes.normalise import normalise

# Shapes of one category differ by less than this between two fair sets; frames that differ, by far more.
_RATIO = 1.25

_SHIFT = 0.1

_SLACK = 0.01

Boxes = Float[np.ndarray, "_ 2 3"]


def bounding_box(vertices: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner."""
    return np.stack([vertices.min(0), vertices.max(0)])


def frame_notes(found: Boxes, real: Boxes) -> list[str]:
    """Warnings about frames: sizes or places that differ, shapes outside the unit cube."""
    return [*_differences(found, real), *_outside(found, "samples"), *_outside(real, "reference")]


def _differences(found: Boxes, real: Boxes) -> list[str]:
    """Medians of the longest sides and of the centres."""
    own, other = (float(np.median(np.ptp(boxes, axis=1).max(1))) for boxes in (found, real))
    centers = [np.median(boxes.mean(1), axis=0) for boxes in (found, real)]
    shift = float(np.linalg.norm(centers[0] - centers[1])) / other
    notes = []
    if not 1 / _RATIO < own / other < _RATIO:
        notes.append(
            f"**The longest side of a sample is {own:.3g}, of a reference mesh {other:.3g} (medians). "
            "Distances measure this, too; --normalise fits every mesh to the unit cube**"
        )
    if shift > _SHIFT:
        notes.append(
            f"**Samples are {shift:.2g} of a longest side away from the reference (medians of the boxes' "
            "centres). Distances measure this, too; --normalise puts every mesh in the unit cube**"
        )
    return notes


def _outside(boxes: Boxes, name: str) -> list[str]:
    count = int(((boxes < -_SLACK) | (boxes > 1 + _SLACK)).any((1, 2)).sum())
    if not count:
        return []
    return [
        f"{count} of {len(boxes)} meshes of the {name} reach out of the unit cube: JSD counts what is "
        "outside in the cells at the border, and lengths are not in sides of the cube"
    ]


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

    def surfaces(self, names: Sequence[str]) -> Iterator[tuple[str, TriangleMesh]]:
        """Name and surface of those meshes that can be used."""
        shown = track(names, f"meshes of {self.root.name}", console=Console(stderr=True), transient=True)
        found = ((name, self.surface(name)) for name in shown)
        return ((name, surface) for name, surface in found if surface is not None)

    def count(self) -> dict[str, int]:
        """Files found, and those of them that have turned out to be unusable."""
        listed = {str(path) for path in self.files.values()} | set(self.problems)
        return {"files": len(listed), "unusable": len(self.problems)}

    def unusable(self) -> set[str]:
        """Names of the meshes that have turned out to be so."""
        return {name for name, path in self.files.items() if str(path) in self.problems}

    def first_problem(self) -> str:
        """One of the reasons, to end an error message with."""
        return "".join(f"; {Path(path).name}: {why}" for path, why in [*self.problems.items()][:1])

    def surface(self, name: str) -> TriangleMesh | None:
        """The triangles of a mesh that have an area, vertices at one position being one; None if unusable.

        Files that store each triangle by itself (.stl), or split vertices where textures do, share edges
        that way.
        """
        path = self.files[name]
        try:
            soup = clean_mesh(parse_mesh(read_file(path), path.suffix.lower()))
        except ShapeError as error:
            self.problems[str(path)] = str(error)
            return None
        return _join(soup, normalise(soup.vertices, 0.0) if self._fit else soup.vertices)


def _join(soup: TriangleMesh, vertices: np.ndarray) -> TriangleMesh:
    positions, place = np.unique(vertices, axis=0, return_inverse=True)
    return TriangleMesh(positions, place.reshape(-1)[soup.faces])
