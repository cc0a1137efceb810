"""Folder of meshes sampled from a model, with its certificate."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd
from jaxtyping import Float

from tetgan.errors import UserError
from tetgan.geometry.triangles import TriangleMesh
from tetgan.solids.reading import read_surface

KINDS = ("generated", "reconstructed")


@dataclass(frozen=True)
class SampleFolder:
    """`{generated,reconstructed}/{id}.ply` and, for meshes of this package, `certificate.csv`."""

    folder: Path

    @cached_property
    def certificate(self) -> pd.DataFrame | None:
        """Rows of the certificate, ids as text; None for meshes made elsewhere.

        Raises:
            UserError: the columns `set` and `id` are missing.
        """
        path = self.folder / "certificate.csv"
        if not path.is_file():
            return None
        try:
            return pd.read_csv(path, dtype={"id": str, "set": str}, na_values=[""], keep_default_na=False)
        except ValueError as error:
            raise UserError(f"{path}: not a certificate ({error})") from None

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
