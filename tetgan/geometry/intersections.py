"""Self-intersections of a triangle surface."""

import igl.predicates
import numpy as np
from jaxtyping import Bool, Float, Int


def self_intersections(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]
) -> Int[np.ndarray, "N 2"]:
    """Pairs of faces that meet anywhere but in the vertices they share, each pair once.

    libigl finds them by a tree of boxes and exact predicates, touching and coplanar faces included. Of faces
    that share an edge it judges those alone right that turn the same way, so those pairs are decided here, by
    its exact predicates too: they meet elsewhere where one is folded flat onto the other. Not found are faces
    that share a vertex and otherwise touch only in that edges lie along each other from it, to the last bit.

    Args:
        vertices: finite.
    """
    if len(faces) == 0:
        return np.empty((0, 2), dtype=np.int64)
    vertices = np.ascontiguousarray(vertices, dtype=np.float64)
    _, found, _ = igl.predicates.find_self_intersections(vertices, np.ascontiguousarray(faces, np.int64))
    pairs = np.sort(found.reshape(-1, 2).astype(np.int64), axis=1)
    apart = pairs[_shared_vertices(faces, pairs) < 2]
    side_by_side = _pairs_on_edges(faces)
    folded = side_by_side[_are_folded(vertices, faces, side_by_side)]
    return np.unique(np.concatenate([apart, folded]), axis=0)


def _shared_vertices(faces: Int[np.ndarray, "F 3"], pairs: Int[np.ndarray, "N 2"]) -> Int[np.ndarray, "N"]:
    one, other = faces[pairs[:, 0]], faces[pairs[:, 1]]
    return (one[:, :, None] == other[:, None, :]).sum(axis=(1, 2))


def _pairs_on_edges(faces: Int[np.ndarray, "F 3"]) -> Int[np.ndarray, "N 2"]:
    """Pairs of faces that share an edge; faces that share all three vertices are one of them."""
    sides = np.sort(faces[:, [[0, 1], [0, 2], [1, 2]]].reshape(-1, 2), axis=1)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    ends, found = sides[order], []
    # Sides of one edge follow one another: each is compared with the next, the one after that, and so on.
    for step in range(1, len(order)):
        same = np.flatnonzero((ends[step:] == ends[:-step]).all(axis=1))
        if len(same) == 0:
            break
        found.append(np.stack([order[same], order[same + step]], axis=1) // 3)
    pairs = np.sort(np.concatenate([np.empty((0, 2), dtype=np.int64), *found]), axis=1)
    return np.unique(pairs, axis=0)


def _are_folded(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], pairs: Int[np.ndarray, "N 2"]
) -> Bool[np.ndarray, "N"]:
    """Whether two faces on a common edge lie in one plane and on the same side of that edge."""
    one, other = faces[pairs[:, 0]], faces[pairs[:, 1]]
    alone = ~(other[:, :, None] == one[:, None, :]).any(axis=2)
    twice = ~alone.any(axis=1)  # the same three vertices
    tip = vertices[np.take_along_axis(other, alone.argmax(axis=1)[:, None], axis=1)[:, 0]]
    common = (one[:, :, None] == other[:, None, :]).any(axis=2)
    # The corners of one face, those on the common edge first.
    order = np.argsort(~common, axis=1, kind="stable")
    start, end, own = np.moveaxis(vertices[np.take_along_axis(one, order, axis=1)], 1, 0)
    flat = _orient(start, end, own, tip) == 0
    return twice | (flat & _on_one_side(start, end, own, tip))


def _on_one_side(
    start: Float[np.ndarray, "N 3"],
    end: Float[np.ndarray, "N 3"],
    one: Float[np.ndarray, "N 3"],
    other: Float[np.ndarray, "N 3"],
) -> Bool[np.ndarray, "N"]:
    """Whether two points in a plane with a line lie on the same side of it.

    A second plane through the line tells; one of those along the three axes is not the first.
    """
    same = np.zeros(len(start), dtype=bool)
    for axis in np.eye(3):
        turns = _orient(start, end, start + axis, one) * _orient(start, end, start + axis, other)
        same |= turns > 0
    return same


def _orient(*points: Float[np.ndarray, "N 3"]) -> Int[np.ndarray, "N"]:
    return igl.predicates.orient3d(*map(np.ascontiguousarray, points)).astype(np.int64)
