"""Faces, edges and face neighbours of a set of tets."""

import numpy as np
from jaxtyping import Int

# Face s lies opposite local vertex s; its corners turn counter-clockwise seen from outside a positive tet.
FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])

EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])


def face_neighbors(tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "T 4"]:
    """Tets across each face.

    Returns:
        (T, 4) int64; slot s is the tet across the face opposite local vertex s, -1 where there is none.

    Raises:
        ValueError: a face belongs to more than two tets.
    """
    keys = face_keys(tets[:, FACES].reshape(-1, 3))
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    if np.any(keys[2:] == keys[:-2]):
        raise ValueError("a face belongs to more than two tets")
    first = np.flatnonzero(keys[1:] == keys[:-1])
    one, other = order[first], order[first + 1]
    neighbors = np.full(tets.size, -1, dtype=np.int64)
    neighbors[one], neighbors[other] = other // 4, one // 4
    return neighbors.reshape(-1, 4)


def boundary_sides(tets: Int[np.ndarray, "T 4"]) -> tuple[Int[np.ndarray, "F"], Int[np.ndarray, "F"]]:
    """Of each face with a tet on one side only, that tet and the local vertex opposite the face.

    Raises:
        ValueError: a face belongs to more than two tets.
    """
    rows, slots = np.nonzero(face_neighbors(tets) < 0)
    return rows, slots


def boundary_faces(tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "F 3"]:
    """The faces of `boundary_sides`, facing away from their tet when it is positive.

    Raises:
        ValueError: a face belongs to more than two tets.
    """
    rows, slots = boundary_sides(tets)
    return np.take_along_axis(tets[rows], FACES[slots], axis=1)


def unique_edges(
    simplices: Int[np.ndarray, "N K"],
) -> tuple[Int[np.ndarray, "E 2"], Int[np.ndarray, "N S"]]:
    """The undirected edges of triangles or tets, each once.

    Returns:
        (E, 2) edges, smaller vertex first, in lexicographic order; and for each simplex the edge of each
        of its sides: 01 02 12 for a triangle, `EDGES` for a tet.
    """
    corners = simplices.shape[1]
    sides = np.stack(np.triu_indices(corners, k=1), axis=1)
    ends = np.sort(simplices[:, sides].reshape(-1, 2), axis=1)
    base = ends.max(initial=0) + 1
    keys, inverse = np.unique(ends[:, 0] * base + ends[:, 1], return_inverse=True)
    edges = np.stack(np.divmod(keys, base), axis=1)
    return edges, inverse.reshape(len(simplices), len(sides))


def face_keys(faces: Int[np.ndarray, "F 3"]) -> Int[np.ndarray, "F"]:
    """One integer a face, the same for every order of its corners."""
    base = int(faces.max(initial=0)) + 1
    if base**3 > np.iinfo(np.int64).max:
        raise ValueError(f"{base:,} vertices: more than two million do not fit the face keys")
    low, middle, high = np.sort(faces, axis=1).T
    return (low * base + middle) * base + high
