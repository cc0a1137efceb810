"""Rows of a certificate: quality and thickness of one solid."""

from dataclasses import asdict
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from tetgan.geometry.boundary import Boundary
from tetgan.geometry.rays import Visibility
from tetgan.geometry.triangles import TriangleMesh, area_normals
from tetgan.solids.certificate import Certificate, certify
from tetgan.solids.solid import SolidMesh

_INWARD = 1e-5  # where rays start behind their face, in cube sides: clear of it in single precision


def median_thickness(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]) -> float:
    """Thickness that half of the surface has no more of.

    The thickness behind a face is the length of the straight way from its centroid through the solid, against
    its normal: the shape diameter of Shapira et al. (2008) with one ray. The faces' median is weighted by
    area, so a thin plate is as thick as it is between its two sides: the rays from its narrow rim run through
    the whole of it, and would lift a mean to three times as much. A ball has its diameter.

    Args:
        faces: a closed surface that faces outward. Rays of faces that inverted tets turned over may lead
            nowhere; they do not count.

    Returns:
        Thickness in the unit of the vertices; 0 without faces or where no ray meets anything.
    """
    if len(faces) == 0:
        return 0.0
    corners = vertices[faces]
    normals = area_normals(corners)
    doubled_areas = np.linalg.norm(normals, axis=1)
    inward = -normals / np.maximum(doubled_areas, np.finfo(float).tiny)[:, None]
    lengths = Visibility(corners).distances(corners.mean(axis=1) + _INWARD * inward, inward) + _INWARD
    counted = np.isfinite(lengths) & (doubled_areas > 0)
    return _weighted_median(lengths[counted], doubled_areas[counted])


def _weighted_median(values: Float[np.ndarray, "N"], weights: Float[np.ndarray, "N"]) -> float:
    """The smallest value up to which lies half of the weight; 0 without values."""
    if len(values) == 0:
        return 0.0
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(below, below[-1] / 2)])


def quality_record(mesh: SolidMesh, certificate: Certificate | None = None) -> dict[str, Any]:
    """One row of the certificate of solids in the unit cube.

    Args:
        certificate: of the mesh, if it is known already.

    Returns:
        The columns of `Certificate`; `thickness` in cube sides (`median_thickness`); of `SolidChanges`
        the counts; and how many floating pieces were dropped, their share of the volume, and
        the shares of each, joined by blanks. All numbers are 0 for an empty mesh.
    """
    changes = asdict(mesh.changes)
    dropped = changes.pop("dropped")
    return {
        **(certificate or certify(mesh.vertices, mesh.tets)).row(),
        "thickness": median_thickness(mesh.vertices, mesh.faces),
        **changes,
        "dropped_components": len(dropped),
        "dropped_volume": float(sum(dropped)),
        "dropped": " ".join(f"{share:.3g}" for share in dropped),
    }


def surface_record(surface: TriangleMesh) -> dict[str, int | float]:
    """One row of the certificate of a surface without tets.

    Returns:
        `faces`; `volume` enclosed, in cubed cube sides; `components` of faces that share vertices;
        `manifold_edges`, the share of edges with exactly two faces. All are 0 for an empty surface.
    """
    return {
        "faces": len(surface.faces),
        "volume": surface.volume,
        "components": surface.components,
        "manifold_edges": Boundary(surface.faces).manifold_edges,
    }
