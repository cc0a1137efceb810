"""Planes of a field made to agree: decoded ones contradict their neighbours', exact ones do not."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from tetgan.meshing.planes import Planes

_NOISY = 0.15  # median disagreement beyond which a field counts as decoded; exact ones have 0.01 to 0.05

_NEIGHBOURS = 12  # planes that a plane is compared with

_WIDTH = 0.5  # of the weights, over the typical edge of the tets

_DOUBT = 0.3  # disagreement at which a plane's slope counts half


def disagreements(planes: Planes, neighbors: Int[np.ndarray, "T 4"]) -> Float[np.ndarray, "T"]:
    """By how much each plane misses the distance that a neighbouring tet knows, over the way there.

    Of the four neighbours the second best is taken: across a thin part or an edge of the surface planes
    differ without being wrong. Infinite where there are fewer than two.
    """
    there = np.where(neighbors >= 0, neighbors, 0)
    ways = planes.centroids[there] - planes.centroids[:, None]
    lengths = np.where(neighbors >= 0, np.linalg.norm(ways, axis=2), 1.0)
    expected = planes.distances[:, None] + np.einsum("tkc,tc->tk", ways, planes.normals)
    missed = np.abs(expected - planes.distances[there]) / lengths
    return np.sort(np.where(neighbors >= 0, missed, np.inf), axis=1)[:, 1]


def make_planes_agree(planes: Planes, neighbors: Int[np.ndarray, "T 4"], edge: float) -> Planes:
    """The planes of an exact field as they are; those of a decoded one averaged with their neighbours'.

    Each plane is moved and turned to the mean of those that touch the surface nearby and face the same way
    (a bilateral filter, after Jones, Durand & Desbrun 2003), but not so far that its centroid would change
    sides. What still disagrees then loses slope: it tells its own distance, and little of what is around.

    Args:
        neighbors: of the tets that the planes are of.
        edge: typical one of the tets.
    """
    near = np.abs(planes.distances) < 2 * edge
    missed = disagreements(planes, neighbors)
    if not near.any() or np.median(missed[near]) < _NOISY:
        return planes
    filtered = _filtered(planes, near, _WIDTH * edge)
    slope = 1 / (1 + (disagreements(filtered, neighbors) / _DOUBT) ** 2)
    return Planes(filtered.centroids, filtered.distances, filtered.normals * slope[:, None])


def _filtered(planes: Planes, near: Bool[np.ndarray, "T"], width: float) -> Planes:
    feet, normals = planes.feet, planes.normals
    others = np.flatnonzero(near)
    away, nearest = KDTree(feet[others]).query(feet, k=np.arange(1, min(_NEIGHBOURS, len(others)) + 1))
    nearest = others[nearest]
    alike = np.einsum("tkc,tc->tk", normals[nearest], normals).clip(0, 1)
    weights = np.exp(-((away / width) ** 2)) * alike**2
    weights /= np.maximum(weights.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    turned = np.einsum("tk,tkc->tc", weights, normals[nearest])
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), np.finfo(float).tiny)
    heights = np.einsum("tkc,tkc->tk", feet[:, None] - feet[nearest], normals[nearest])
    moved = feet - (weights * heights).sum(axis=1, keepdims=True) * turned
    distances = np.einsum("tc,tc->t", planes.centroids - moved, turned)
    kept = distances * planes.distances > 0
    return Planes(
        planes.centroids,
        np.where(kept, distances, planes.distances),
        np.where(kept[:, None], turned, normals),
    )
