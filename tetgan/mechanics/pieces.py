"""Face-connected pieces of a tet mesh, and whether each is held by a support."""

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.components import connect_tets
from tetgan.geometry.tets import TetMesh
from tetgan.mechanics.assembly import rigid_motions
from tetgan.mechanics.errors import UnfitError

_LOOSE = 1e-6  # how little of a motion the supports may see, over what they see of another, to leave it free


def label_pieces(tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "T"]:
    """Number of the piece of each tet; tets of one piece are joined by faces, not by edges or vertices alone.

    Raises:
        UnfitError: a face belongs to more than two tets.
    """
    found = connect_tets(tets)
    if found.crowded_faces:
        raise UnfitError(
            "crowded faces",
            f"{found.crowded_faces} faces belong to more than two tets; 'tetgan certify' tells more",
        )
    return found.component


def largest_piece(solid: TetMesh) -> TetMesh:
    """The piece with the most tets, on the vertices it uses; of equal ones the first.

    Raises:
        UnfitError: a face belongs to more than two tets.
    """
    labels = label_pieces(solid.tets)
    kept = solid.tets[labels == np.bincount(labels).argmax()]
    used, compact = np.unique(kept, return_inverse=True)
    return TetMesh(solid.vertices[used], compact.reshape(-1, 4))


def share_left_out(solid: TetMesh, piece: TetMesh) -> float:
    """Share of a solid's volume that a piece of it lacks, 0 to 1; exactly 0 where the piece is all."""
    if len(piece.tets) == len(solid.tets):
        return 0.0
    return 1 - float(np.abs(piece.volumes).sum() / np.abs(solid.volumes).sum())


def count_free_motions(points: Float[np.ndarray, "N 3"], held: Bool[np.ndarray, "N 3"]) -> int:
    """Rigid motions of a piece that its supports do not prevent, 0 to 6.

    Args:
        points: nodes of the piece.
        held: which of their components are zero.
    """
    prevented = rigid_motions(points)[held.ravel()]
    squares = np.linalg.eigvalsh(prevented.T @ prevented)
    return int((squares <= _LOOSE**2 * squares.max()).sum())
