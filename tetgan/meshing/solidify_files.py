"""Stage: a mesh file, or a folder of them, to certified solids and a table of them."""

import json
from collections import Counter
from collections.abc import Sequence
from glob import escape
from pathlib import Path
from queue import SimpleQueue
from typing import Any, ClassVar, NamedTuple

import numpy as np
import pandas as pd

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.meshing.solidify import SolidifyOptions, SolidifyReport
from tetgan.progress import map_threads
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.isolation import MeshWorker
from tetgan.shapes.loading import MESH_SUFFIXES
from tetgan.solids.export import SOLIDS, SURFACES

TABLE = "solidify.csv"


class Outcome(NamedTuple):
    """A mesh, where its solid is, and what was made of it; or the problem with it.

    `name` and `out` are places in the two folders.
    """

    name: str
    out: str
    report: SolidifyReport | None
    problem: str = ""

    def row(self) -> dict[str, Any]:
        """Columns of a table."""
        done = {"mesh": self.name, "solid": self.out if self.report else "", "problem": self.problem}
        return done | (self.report.row() if self.report else {})

    def line(self) -> str:
        """One line for people."""
        report = self.report
        if report is None:
            return f"{self.name}: no solid: {self.problem}"
        repaired = f", {report.repair} ({report.reason})" if report.reason else ""
        return (
            f"{self.name}: valid; {report.tets:,} tets,"
            f" dihedral angles from {report.min_dihedral:.2f} degrees,"
            f" volume {report.volume_out:.6g} of {report.volume_in:.6g},"
            f" distance {report.mean_distance:.3g} (at most {report.hausdorff:.3g}),"
            f" {report.seconds:.1f} s{repaired}"
        )


class SolidifyWorker(MeshWorker):
    """Solids made in a child process; see `MeshWorker`."""

    task: ClassVar[str] = "solidify"
    module: ClassVar[str] = "tetgan.meshing.solidify_worker"

    def solidify(self, path: Path, out: Path) -> dict[str, Any]:
        """One file through the child, which writes `out`.

        Raises:
            ShapeError: no solid can be made of it, or the child crashed or took too long.
        """
        answer = self._exchange({"path": np.array(str(path)), "out": np.array(str(out))})
        row = json.loads(str(answer["row"]))
        if "problem" in row:
            raise ShapeError(row["problem"])
        return row


def solidify_files(
    source: Path, target: Path, options: SolidifyOptions, *, workers: int = 1, suffix: str = ".vtu"
) -> list[Outcome]:
    """Make a solid of every mesh; one of which none can be made is listed with its problem.

    Args:
        source: a file, or a folder: then all meshes in it and its folders, whose names and places are kept.
        target: the file to write, or the folder; a folder also gets `solidify.csv`, a row for each mesh.
        workers: meshes at once, each in a process of its own.
        suffix: of the solids in a folder.

    Raises:
        UserError: the source is missing or has no meshes, or nothing can be written as `suffix`.
    """
    if source.is_dir():
        check_output(Path(suffix), suffix)
        jobs = _jobs(source, target, suffix)
        root = target
    elif source.exists():
        check_output(target, target.suffix)
        jobs, root = [(source, target)], target.parent
    else:
        raise UserError(f"{source}: no such file or folder")
    found = _run(jobs, source if source.is_dir() else source.parent, root, options, min(workers, len(jobs)))
    if source.is_dir():
        with whole_file(target / TABLE) as partial:
            pd.DataFrame([one.row() for one in found], columns=_columns()).to_csv(partial, index=False)
    return found


def check_output(path: Path, suffix: str) -> None:
    """Say in time that no mesh can be written so.

    Raises:
        UserError: there is no such format.
    """
    if suffix.lower() not in (*SOLIDS, *SURFACES):
        raise UserError(
            f"{path}: no mesh format '{suffix}' to write; use one of {' '.join(SOLIDS + SURFACES)}"
        )


def _columns() -> list[str]:
    return ["mesh", "solid", "problem", *SolidifyReport.__dataclass_fields__]


def _jobs(source: Path, target: Path, suffix: str) -> list[tuple[Path, Path]]:
    """Every mesh in a folder and where its solid goes; one name for two keeps their suffixes."""
    meshes = sorted(
        path
        for path in source.rglob("*")
        if path.suffix.lower() in MESH_SUFFIXES
        and path.is_file()
        and not any(part.startswith(".") for part in path.relative_to(source).parts)
        and (source.resolve() == target.resolve() or not path.resolve().is_relative_to(target.resolve()))
    )
    if not meshes:
        raise UserError(f"{source}: no meshes ({' '.join(sorted(MESH_SUFFIXES))}) in this folder")
    if source.resolve() == target.resolve() and suffix.lower() in MESH_SUFFIXES:
        raise UserError(f"{target}: the solids would replace the meshes; name another folder")
    places = [path.relative_to(source).with_suffix("") for path in meshes]
    uses = Counter(str(place).lower() for place in places)
    names = [
        str(place) if uses[str(place).lower()] == 1 else str(path.relative_to(source))
        for place, path in zip(places, meshes, strict=True)
    ]
    return [(path, target / (name + suffix)) for path, name in zip(meshes, names, strict=True)]


def _run(
    jobs: Sequence[tuple[Path, Path]], source: Path, target: Path, options: SolidifyOptions, workers: int
) -> list[Outcome]:
    free: SimpleQueue[SolidifyWorker] = SimpleQueue()
    pool = [SolidifyWorker(options) for _ in range(workers)]
    for worker in pool:
        free.put(worker)

    def solidify(job: tuple[Path, Path]) -> Outcome:
        path, out = job
        name, place = path.relative_to(source).as_posix(), out.relative_to(target).as_posix()
        worker = free.get()
        try:
            return Outcome(name, place, SolidifyReport(**worker.solidify(path, out)))
        except ShapeError as error:
            for partial in out.parent.glob(
                f".*.partial.{escape(out.name)}"
            ):  # the child may have been killed
                partial.unlink(missing_ok=True)
            return Outcome(name, place, None, " ".join(str(error).split()))
        finally:
            free.put(worker)

    try:
        return map_threads(solidify, jobs, workers, "solidify")
    finally:
        for worker in pool:
            worker.close()
