"""Floating pieces and cavities of an occupancy."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from tetgan.geometry.components import label_components
from tetgan.meshing.collared_grid import CollaredGrid


class Dropped(NamedTuple):
    """Occupancy without the smallest of its pieces.

    Attributes:
        occupancy: what is left.
        volumes: (N,) of each piece dropped, in cubed cube sides.
    """

    occupancy: Bool[np.ndarray, "T"]
    volumes: Float[np.ndarray, "N"]


def drop_small_pieces(
    occupancy: Bool[np.ndarray, "T"],
    ambient: CollaredGrid,
    smallest: float,
    *,
    joined_by: Literal["faces", "vertices"],
) -> Dropped:
    """Empty the pieces of less than some volume; the largest stays in any case.

    Args:
        smallest: least volume of a piece, in cubed cube sides.
        joined_by: what two tets of one piece have in common.
    """
    tets = np.flatnonzero(occupancy)
    labels = (label_by_faces if joined_by == "faces" else _label_by_vertices)(tets, ambient)
    volumes = np.bincount(labels, ambient.volumes[tets])
    dropped = volumes < min(smallest, volumes.max(initial=0))
    left = occupancy.copy()
    left[tets[dropped[labels]]] = False
    return Dropped(left, volumes[dropped])


def count_cavities(occupancy: Bool[np.ndarray, "T"], ambient: CollaredGrid) -> int:
    """Pieces of empty tets, joined by faces, that do not reach the collar."""
    tets = np.flatnonzero(~occupancy)
    labels = label_by_faces(tets, ambient)
    return len(np.setdiff1d(labels, labels[tets >= ambient.grid_tets]))


def label_by_faces(tets: Int[np.ndarray, "N"], ambient: CollaredGrid) -> Int[np.ndarray, "N"]:
    number = np.full(len(ambient.tets) + 1, -1)  # the -1 of a missing neighbour reads the last entry
    number[tets] = np.arange(len(tets))
    beside = number[ambient.neighbors[tets]]
    rows, slots = np.nonzero(beside >= 0)
    return label_components(rows, beside[rows, slots], len(tets))


def _label_by_vertices(tets: Int[np.ndarray, "N"], ambient: CollaredGrid) -> Int[np.ndarray, "N"]:
    corners = ambient.tets[tets]
    ends = np.repeat(corners[:, 0], 3), corners[:, 1:].ravel()
    labels = label_components(*ends, len(ambient.vertices))  # of vertices, those without tets too
    return np.unique(labels[corners[:, 0]], return_inverse=True)[1]
