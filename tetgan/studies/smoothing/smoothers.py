"""Laplacian smoothing with wLS, uniform or cotangent weights, and the solids it gives."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import igl
import numpy as np
from jaxtyping import Float, Int
from scipy import sparse

from tetgan.fields.field import Field
from tetgan.geometry.adjacency import unique_edges
from tetgan.grids.grid import TetGrid
from tetgan.meshing.build import build_solid
from tetgan.meshing.filtering import filter_occupancy
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.smoothing import pull_to_neighbors, smooth_vertices
from tetgan.solids.solid import SolidMesh
from tetgan.studies.smoothing.files import VARIANTS, Variant

Vertices = Float[np.ndarray, "V 3"]

Faces = Int[np.ndarray, "F 3"]

Smoother = Callable[[Vertices, Vertices, Faces, float], Vertices]
"""From displaced vertices, their displacement, the surface's faces and beta to smoothed vertices."""


# Half the cotangent of 1e-6 radians: a sliver's weight is bounded, so that sums stay finite.
_LARGEST_WEIGHT = 5e5


def smooth_uniform(vertices: Vertices, displacement: Vertices, faces: Faces, beta: float) -> Vertices:
    """Plain Laplacian: every neighbour weighs the same; `displacement` plays no part."""
    edges, _ = unique_edges(faces)
    return pull_to_neighbors(vertices, edges, np.ones(len(edges)), beta)


def smooth_cotangent(vertices: Vertices, displacement: Vertices, faces: Faces, beta: float) -> Vertices:
    """Cotangent Laplacian: (cot a + cot b)/2 of the angles facing an edge; `displacement` plays no part.

    Obtuse angles can make a weight negative, which would throw a vertex out of its neighbourhood: such
    weights, and those of triangles without area, count as zero.
    """
    edges, _ = unique_edges(faces)
    if not len(edges):
        return vertices.copy()
    weights = np.asarray(igl.cotmatrix(vertices, faces)[edges[:, 0], edges[:, 1]], dtype=np.float64).ravel()
    weights = np.nan_to_num(weights, nan=0.0, posinf=0.0, neginf=0.0).clip(0, _LARGEST_WEIGHT)
    return pull_to_neighbors(vertices, edges, weights, beta)


SMOOTHERS: dict[str, Smoother] = {
    "wls": smooth_vertices,
    "uniform": smooth_uniform,
    "cotangent": smooth_cotangent,
}
"""Eq. 4, plain and cotangent; each takes the same single step with the same beta."""


def build_variants(
    field: Field, grid: TetGrid, operator: sparse.csr_array, mu: float, options: MeshingOptions
) -> Mapping[Variant, SolidMesh]:
    """Every variant of one field, all on the same tets: those that Eq. 5 leaves, as in mode `paper`.

    Without displacement, Eq. 4 still takes its weights from the displacement that is not applied.

    Args:
        grid, operator, mu, options: as `build_solid`.
    """
    options = options.model_copy(update={"mode": "paper"})  # `solid` would smooth as far as the tets allow
    occupancy = filter_occupancy(field, grid.neighbors, mu, options.gamma)
    still, moved = (
        build_solid(Field(occupancy, by), grid, operator, np.inf, options, smoothing=False)
        for by in (np.zeros_like(field.displacement), field.displacement)
    )
    # Of the boundary vertices, which are all that smoothing looks at.
    displacement = moved.vertices - still.vertices
    solids = {}
    for variant in VARIANTS:
        solid = moved if variant.displaced else still
        if variant.smoothing != "none":
            smooth = SMOOTHERS[variant.smoothing]
            solid = replace(solid, vertices=smooth(solid.vertices, displacement, solid.faces, options.beta))
        solids[variant] = solid
    return solids
