"""Stage: certificates of meshes in files."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import pandas as pd
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.meshing.certificate import Certificate, certify
from tetgan.meshing.reading import find_meshes, read_tets

TABLE = "certificate.csv"


class Certified(NamedTuple):
    """A file, by the name that its certificate goes by."""

    name: str
    path: Path
    certificate: Certificate


def certify_files(paths: Sequence[Path], out: Path | None) -> list[Certified]:
    """Certify files, and the files in folders.

    Args:
        out: folder that receives `{name}.json` for each mesh, where a name keeps its suffix and its place
            within a folder, and a row for each in `certificate.csv`; None: nothing is written.

    Raises:
        UserError: a file or folder is missing or unusable, or two meshes have one name.
    """
    files = [(path, file) for path in paths for file in find_meshes(path)]
    names = [file.relative_to(path).as_posix() if path.is_dir() else file.name for path, file in files]
    if out is not None:
        for name in {name for name in names if names.count(name) > 1}:
            raise UserError(f"{name}: two meshes of this name; certify their folders apart")
    shown = track(files, "certifying", console=Console(stderr=True), transient=True, disable=len(files) < 2)
    found = [Certified(name, file, _certify_file(file)) for name, (_, file) in zip(names, shown, strict=True)]
    if out is not None:
        _write(found, out)
    return found


def verdict(path: Path, found: Certificate) -> str:
    """One line for people."""
    if not found.tets:
        return f"{path}: not valid: no tets"
    figures = (
        f"{found.tets:,} tets, dihedral angles from {found.min_dihedral:.2f} degrees, "
        f"{found.components} component{'s' * (found.components != 1)}, "
        f"{found.cavities} cavit{'ies' if found.cavities != 1 else 'y'}, volume {found.volume:.6g}"
    )
    state = "valid" if found.valid else f"not valid: {', '.join(found.reasons)}"
    if found.inverted_tets == found.tets:
        state += " (all: is the order of their vertices another one?)"
    return f"{path}: {state}; {figures}"


def write_certificate(path: Path, found: Certificate) -> None:
    """The certificate of one mesh as JSON."""
    with whole_file(path) as partial:
        partial.write_text(json.dumps(found.to_json(), indent=1) + "\n")


def _certify_file(path: Path) -> Certificate:
    vertices, tets = read_tets(path)
    try:
        return certify(vertices, tets)
    except ValueError as error:
        raise UserError(f"{path}: {error}") from None


def _write(found: Sequence[Certified], out: Path) -> None:
    for one in found:
        write_certificate(out / f"{one.name}.json", one.certificate)
    with whole_file(out / TABLE) as partial:
        rows = [{"mesh": one.name, **one.certificate.row()} for one in found]
        pd.DataFrame(rows).to_csv(partial, index=False)
