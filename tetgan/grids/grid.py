"""The tetrahedral grid."""

import hashlib
from functools import cached_property

from tetgan.geometry.tets import TetMesh


class TetGrid(TetMesh):
    """Tets of the unit cube that share faces, every one positive: det(v1-v0, v2-v0, v3-v0) > 0."""

    @cached_property
    def digest(self) -> str:
        """SHA-256 of vertices and tets, hexadecimal: equal exactly when the grids are."""
        sha = hashlib.sha256()
        for array, kind in ((self.vertices, "<f8"), (self.tets, "<i8")):
            sha.update(str(array.shape).encode())
            sha.update(array.astype(kind).tobytes())
        return sha.hexdigest()
