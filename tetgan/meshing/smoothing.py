"""Eq. 4: Laplacian smoothing weighted by the displacement field."""

import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.adjacency import unique_edges


def smooth_vertices(
    vertices: Float[np.ndarray, "V 3"],
    displacement: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    beta: float,
) -> Float[np.ndarray, "V 3"]:
    """One step of  beta·v_i + (1-beta)·sum_j w_ij v_j / sum_j w_ij  with  w_ij = |cos(D_i, D_j)|.

    Neighbours are joined by an edge of `faces`. As printed, Eq. 4 does not divide by the weights, which
    would move a mesh far from where it lies; the official code normalises too. A vertex whose weights are
    all zero, off the surface or displaced at right angles to its neighbours, stays.

    Args:
        vertices: already displaced.
        displacement: the vertex displacement of Eq. 3, any length.
    """
    edges, _ = unique_edges(faces)
    length = np.linalg.norm(displacement, axis=1, keepdims=True)
    direction = np.divide(displacement, length, out=np.zeros_like(displacement), where=length > 0)
    weights = np.abs(np.einsum("ec,ec->e", *direction[edges.T]))
    return pull_to_neighbors(vertices, edges, weights, beta)


def pull_to_neighbors(
    vertices: Float[np.ndarray, "V 3"],
    edges: Int[np.ndarray, "E 2"],
    weights: Float[np.ndarray, "E"],
    beta: float,
) -> Float[np.ndarray, "V 3"]:
    """beta of each vertex and 1 - beta of the weighted mean of its neighbours; one without weights stays.

    Args:
        edges: each once.
        weights: of the edges, none negative.
    """
    ends, others = np.concatenate([edges, edges[:, ::-1]]).T
    weights = np.concatenate([weights, weights])
    total = np.bincount(ends, weights, minlength=len(vertices))[:, None]
    pulled = np.stack(
        [np.bincount(ends, weights * axis[others], minlength=len(vertices)) for axis in vertices.T], axis=1
    )
    mean = np.divide(pulled, total, out=vertices.copy(), where=total > 0)
    return beta * vertices + (1 - beta) * mean
