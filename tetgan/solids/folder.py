"""Folders of meshes that a model made, and their certificates: one row per mesh in `certificate.csv`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jaxtyping import Float

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.geometry.triangles import TriangleMesh
from tetgan.solids.reading import read_surface

CERTIFICATE = "certificate.csv"

CERTIFICATES = f"*/{CERTIFICATE}"
"""The certificates in a folder of samples, which has a folder for each smoothing."""

KINDS = ("generated", "reconstructed")


def write_certificates(folder: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write one row per mesh; of samples each has `set` and `id`."""
    with whole_file(folder / CERTIFICATE) as partial:
        pd.DataFrame(rows).to_csv(partial, index=False)


def read_certificates(folder: Path) -> pd.DataFrame | None:
    """Rows of the samples in a folder, `set` and `id` as text whatever they look like; None without a file.

    Raises:
        UserError: not a table, or the columns `set` and `id` are missing.
    """
    path = folder / CERTIFICATE
    if not path.is_file():
        return None
    try:
        table = pd.read_csv(path, dtype={"id": str, "set": str}, na_values=[""], keep_default_na=False)
    except ValueError as error:
        raise UserError(f"{path}: not a certificate ({error}); sample again") from None
    if not {"set", "id"}.issubset(table.columns):
        raise UserError(f"{path}: not a certificate (no columns 'set' and 'id'); sample again")
    return table


@dataclass(frozen=True)
class SampleFolder:
    """`{generated,reconstructed}/{id}.ply` and, for meshes of this package, `certificate.csv`."""

    folder: Path

    @cached_property
    def certificate(self) -> pd.DataFrame | None:
        """Rows of the certificate, see `read_certificates`; None for meshes made elsewhere."""
        return read_certificates(self.folder)

    def ids(self, kind: str) -> list[str]:
        """Ids of a kind, certified ones whether or not they have a mesh."""
        if self.certificate is None:
            return sorted(path.stem for path in (self.folder / kind).glob("*.ply"))
        return sorted(self.certificate.loc[self.certificate["set"] == kind, "id"])

    def surface(self, kind: str, shape_id: str) -> TriangleMesh | None:
        """The mesh, None where it is missing or empty."""
        return read_surface(self.folder / kind / f"{shape_id}.ply")

    def certified(self, kind: str, column: str) -> Float[np.ndarray, "N"]:
        """Known values of a column of the certificate, in the order of the ids."""
        if self.certificate is None or column not in self.certificate:
            return np.empty(0)
        rows = self.certificate[self.certificate["set"] == kind].sort_values("id")
        return rows[column].dropna().to_numpy(dtype=np.float64)

    def of_solids(self, kind: str, column: str) -> Float[np.ndarray, "N"]:
        """The same of the shapes that are not empty."""
        values, tets = self.certified(kind, column), self.certified(kind, "tets")
        return values[tets > 0] if len(tets) == len(values) else np.empty(0)

    def inverted_shares(self, kind: str) -> Float[np.ndarray, "N"]:
        """Inverted share of the tets of every mesh that has tets."""
        inverted = self.of_solids(kind, "inverted_tets")
        return inverted / self.of_solids(kind, "tets") if len(inverted) else inverted


def finished_samples(samples: Path) -> Path:
    """The folder of a model's meshes as they are meant to be shown: smoothed, where the model smooths."""
    return samples / "wls" if (samples / "wls").is_dir() else samples / "none"


def sample_ids(folder: Path, kind: str, count: int | None = None) -> list[str]:
    """Ids of the first `count` meshes of a kind, `generated` or `reconstructed`, in a folder of samples.

    The certificate, where there is one, also names the shapes that came out empty.
    """
    table = read_certificates(folder)
    if table is not None:
        return table.loc[table["set"] == kind, "id"].tolist()[:count]
    return sorted(path.stem for path in (folder / kind).glob("*.ply"))[:count]
