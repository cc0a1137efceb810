"""Rows of a certificate: what is written beside every sample."""

from dataclasses import asdict
from typing import Any

import numpy as np
from jaxtyping import Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from tetgan.meshing.boundary import Boundary
from tetgan.meshing.certificate import Certificate, certify
from tetgan.meshing.solid import SolidMesh
from tetgan.meshing.thickness import median_thickness
from tetgan.shapes.soup import Soup


def quality_record(mesh: SolidMesh, certificate: Certificate | None = None) -> dict[str, Any]:
    """One row of the certificate of solids in the unit cube.

    Args:
        certificate: of the mesh, if it is known already.

    Returns:
        The columns of `Certificate`; `thickness` in cube sides (`median_thickness`); of `SolidChanges`
        what was added and removed; and how many floating pieces were dropped, their share of the volume, and
        the shares of each, joined by blanks. All numbers are 0 for an empty mesh.
    """
    changes = asdict(mesh.changes)
    del changes["cavities"]  # the certificate counts them in the mesh itself
    dropped = changes.pop("dropped")
    return {
        **(certificate or certify(mesh.vertices, mesh.tets)).row(),
        "thickness": median_thickness(mesh.vertices, mesh.faces),
        **changes,
        "dropped_components": len(dropped),
        "dropped_volume": float(sum(dropped)),
        "dropped": " ".join(f"{share:.3g}" for share in dropped),
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
        "manifold_edges": Boundary(surface.faces).manifold_edges,
    }


def _vertex_component_count(faces: Int[np.ndarray, "F 3"]) -> int:
    used, compact = np.unique(faces, return_inverse=True)
    if len(used) == 0:
        return 0
    a, b, c = compact.reshape(-1, 3).T
    ends = np.concatenate([a, b]), np.concatenate([b, c])
    links = sparse.coo_array((np.ones(len(ends[0]), dtype=bool), ends), shape=(len(used),) * 2)
    return int(connected_components(links, directed=False, return_labels=False))
