"""Figures that tell how fit a solid mesh is for use."""

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from tetgan.grids.adjacency import EDGES, FACES, face_neighbors, unique_edges
from tetgan.grids.grid import tet_volumes
from tetgan.meshing.solid import SolidMesh
from tetgan.meshing.thickness import median_thickness
from tetgan.shapes.soup import Soup


def quality_record(mesh: SolidMesh) -> dict[str, int | float]:
    """One row of a certificate.

    Returns:
        `tets`, `faces`; `inverted_tets`, of no or negative volume; `min_dihedral` in degrees over all tets,
        which does not see whether a tet is inverted; `volume`, signed, in cubed cube sides; `thickness` in
        cube sides (`median_thickness`); `components` of tets joined by faces; `floating`, the share of tets
        outside the largest of them; `manifold_edges`, the share of surface edges with exactly two faces.
        All are 0 for an empty mesh.
    """
    volumes = tet_volumes(mesh.vertices, mesh.tets)
    components = _component_sizes(mesh.tets)
    return {
        "tets": len(mesh.tets),
        "faces": len(mesh.faces),
        "inverted_tets": int((volumes <= 0).sum()),
        "min_dihedral": float(dihedral_angles(mesh.vertices, mesh.tets).min()) if len(mesh.tets) else 0.0,
        "volume": float(volumes.sum()),
        "thickness": median_thickness(mesh.vertices, mesh.faces),
        "components": len(components),
        "floating": float(1 - components.max() / len(mesh.tets)) if len(mesh.tets) else 0.0,
        "manifold_edges": _manifold_share(mesh.faces),
    }


def surface_record(surface: Soup) -> dict[str, int | float]:
    """One row of the certificate of a surface without tets.

    Returns:
        `faces`; `volume` enclosed, in cubed cube sides; `components` of faces that share vertices;
        `manifold_edges`, the share of edges with exactly two faces. All are 0 for an empty surface.
    """
    corners = surface.triangles - 0.5
    return {
        "faces": len(surface.faces),
        "volume": float(np.linalg.det(corners).sum() / 6),
        "components": _vertex_component_count(surface.faces),
        "manifold_edges": _manifold_share(surface.faces),
    }


def dihedral_angles(
    vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]
) -> Float[np.ndarray, "T 6"]:
    """Angles in degrees between the two faces at each edge, in the order of `EDGES`.

    A tet flattened to a plane has angles of 0 and 180.
    """
    corners = vertices[tets[:, FACES]]
    normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    # Faces i and j meet at the edge that has neither of the vertices i and j: the opposite one in EDGES.
    one, other = np.moveaxis(normals[:, EDGES[::-1]], 2, 0)
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    cosine = -np.einsum("tec,tec->te", one, other)
    return np.degrees(np.arctan2(sine, cosine))


def radius_ratios(vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"]) -> Float[np.ndarray, "T"]:
    """Three times the radius of the inscribed sphere over that of the circumscribed one.

    1 for a regular tet, 0 for a flat one; like the angles it does not see whether a tet is inverted.
    """
    corners = vertices[tets]
    one, two, three = np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 0)
    sides = corners[:, FACES]
    areas = np.linalg.norm(np.cross(sides[:, :, 1] - sides[:, :, 0], sides[:, :, 2] - sides[:, :, 0]), axis=2)
    crosses = np.cross(two, three), np.cross(three, one), np.cross(one, two)
    squares = ((edge**2).sum(axis=1)[:, None] for edge in (one, two, three))
    # With v six times the volume: inner radius v / sum(areas), outer |w| / 2v; areas are doubled here.
    w = np.linalg.norm(sum(square * cross for square, cross in zip(squares, crosses, strict=True)), axis=1)
    v = (one * crosses[0]).sum(axis=1)
    below = areas.sum(axis=1) * w
    return np.divide(6 * v**2, below, out=np.zeros_like(v), where=below > 0)


def _component_sizes(tets: Int[np.ndarray, "T 4"]) -> Int[np.ndarray, "N"]:
    """Tets of each component."""
    if len(tets) == 0:
        return np.empty(0, dtype=np.int64)
    neighbors = face_neighbors(tets)
    rows, slots = np.nonzero(neighbors >= 0)
    links = sparse.coo_array(
        (np.ones(len(rows), dtype=bool), (rows, neighbors[rows, slots])), shape=(len(tets),) * 2
    )
    return np.bincount(connected_components(links, directed=False)[1])


def _vertex_component_count(faces: Int[np.ndarray, "F 3"]) -> int:
    used, compact = np.unique(faces, return_inverse=True)
    if len(used) == 0:
        return 0
    a, b, c = compact.reshape(-1, 3).T
    ends = np.concatenate([a, b]), np.concatenate([b, c])
    links = sparse.coo_array((np.ones(len(ends[0]), dtype=bool), ends), shape=(len(used),) * 2)
    return int(connected_components(links, directed=False, return_labels=False))


def _manifold_share(faces: Int[np.ndarray, "F 3"]) -> float:
    if len(faces) == 0:
        return 0.0
    edges, edge_of_side = unique_edges(faces)
    return float((np.bincount(edge_of_side.ravel(), minlength=len(edges)) == 2).mean())
