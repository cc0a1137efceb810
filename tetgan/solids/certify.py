"""Stage: certificates of meshes in files."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.solids.certificate import Certificate, certify
from tetgan.solids.folder import write_certificates
from tetgan.solids.reading import find_meshes, read_tets


class Certified(NamedTuple):
    """A file, by the name that its certificate goes by; or why it could not be certified."""

    name: str
    path: Path
    certificate: Certificate | None
    problem: str = ""

    @property
    def valid(self) -> bool:
        return self.certificate is not None and self.certificate.valid

    def row(self) -> dict[str, Any]:
        """Columns of a table."""
        if self.certificate is None:
            return {"mesh": self.name, "valid": False, "reasons": self.problem}
        return {"mesh": self.name, **self.certificate.row()}

    def to_json(self) -> dict[str, Any]:
        if self.certificate is None:
            return {"valid": False, "reasons": [self.problem]}
        return self.certificate.to_json()


def certify_files(paths: Sequence[Path], out: Path | None) -> list[Certified]:
    """Certify files, and the files in folders. One of several that cannot be used is listed with its reason.

    Args:
        out: folder that receives `{name}.json` for each mesh, where a name keeps its suffix and its place
            within the folder that holds all of them, and a row for each in `certificate.csv`; None: nothing
            is written.

    Raises:
        UserError: a folder is missing or has no meshes, or the only file cannot be used.
    """
    files = sorted({file: None for path in paths for file in find_meshes(path)})
    shown = track(files, "certifying", console=Console(stderr=True), transient=True, disable=len(files) < 2)
    found = []
    for name, file in zip(_names(files), shown, strict=True):
        try:
            found.append(Certified(name, file, _certify_file(file)))
        except UserError as error:
            if len(files) == 1:
                raise
            found.append(Certified(name, file, None, str(error).removeprefix(f"{file}: ")))
    if out is not None:
        _write(found, out)
    return found


def _names(files: Sequence[Path]) -> list[str]:
    """Places within the nearest folder that holds them all."""
    whole = [file.absolute() for file in files]
    root = Path(os.path.commonpath([file.parent for file in whole]))
    return [file.relative_to(root).as_posix() for file in whole]


def verdict(one: Certified) -> str:
    """One line for people."""
    found = one.certificate
    if found is None:
        return f"{one.path}: not usable: {one.problem}"
    if not found.tets:
        return f"{one.path}: not valid: no tets"
    figures = (
        f"{found.tets:,} tets, dihedral angles from {found.min_dihedral:.2f} degrees, "
        f"{found.components} component{'s' * (found.components != 1)}, "
        f"{found.cavities} cavit{'ies' if found.cavities != 1 else 'y'}, volume {found.volume:.6g}"
    )
    state = "valid" if found.valid else f"not valid: {', '.join(found.reasons)}"
    if found.inverted_tets == found.tets:
        state += " (all: is the order of their vertices another one?)"
    return f"{one.path}: {state}; {figures}"


def write_certificate(path: Path, found: Certificate) -> None:
    """The certificate of one mesh as JSON."""
    _write_json(path, found.to_json())


def _certify_file(path: Path) -> Certificate:
    vertices, tets = read_tets(path)
    try:
        return certify(vertices, tets)
    except ValueError as error:
        raise UserError(f"{path}: {error}") from None


def _write(found: Sequence[Certified], out: Path) -> None:
    for one in found:
        _write_json(out / f"{one.name}.json", one.to_json())
    write_certificates(out, [one.row() for one in found])


def _write_json(path: Path, values: Mapping[str, Any]) -> None:
    with whole_file(path) as partial:
        partial.write_text(json.dumps(values, indent=1) + "\n")
