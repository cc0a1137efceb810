"""From a field to a solid mesh."""

import numpy as np
from jaxtyping import Bool, Float
from scipy import sparse

from tetgan.fields.field import Field, VertexField
from tetgan.geometry.adjacency import boundary_faces
from tetgan.grids.grid import TetGrid
from tetgan.meshing.filtering import filter_occupancy
from tetgan.meshing.injective import move_boundary
from tetgan.meshing.occupancy import valid_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.smoothing import smooth_vertices
from tetgan.solids.solid import SolidChanges, SolidMesh

_FAR = 4.0  # mean displacements of surface tets from the surface: beyond that every tet costs the same

_EMPTYING = 4.0  # times what filling costs


def build_solid(
    field: Field | VertexField,
    grid: TetGrid,
    operator: sparse.csr_array,
    mu: float,
    options: MeshingOptions,
    *,
    smoothing: bool,
) -> SolidMesh:
    """Filter (Eq. 5), displace the boundary (Eq. 3) and, if asked, smooth it (Eq. 4).

    In mode `paper` that is all, and only boundary vertices move: moving the others too inverts more tets, and
    gains the surface nothing. Even so a few per cent of the tets may come out inverted, and boundary edges
    may have four faces; `quality_record` counts them.

    In mode `solid` the boundary is first made a manifold, with as little change of the occupancy as may be
    (`valid_solid`), whose vertices then go towards the same places as far as every tet allows
    (`move_boundary`). See docs/solids.md.

    Args:
        grid: the finest grid of the hierarchy, which the field lives on.
        operator: `vertex_operator(grid)`, made once for many fields.
        mu: the data set's mean displacement of surface tets.

    Returns:
        The solid; without tets where nothing is occupied.
    """
    occupancy = filter_occupancy(field, grid.neighbors, mu, options.gamma)
    if options.mode == "solid":
        solid, changes = valid_solid(occupancy, _reluctance(field, occupancy, mu), grid, options)
        vertices, tets, blend = solid.space.vertices, solid.space.tets[solid.occupancy], solid.blend
    else:
        changes = SolidChanges()
        vertices, tets, blend = (
            grid.vertices,
            grid.tets[occupancy],
            sparse.eye_array(len(grid.vertices), format="csr"),
        )
    used, compact = np.unique(tets, return_inverse=True)
    tets = compact.reshape(-1, 4)
    faces = boundary_faces(tets)
    vertices, displacement = vertices[used], _displacement_at(blend[used], field, operator)
    boundary = np.unique(faces)
    vertices[boundary] += displacement[boundary]
    if smoothing:
        vertices = smooth_vertices(vertices, displacement, faces, options.beta)
    if options.mode == "solid":
        vertices = move_boundary(
            solid.occupancy,
            used[boundary],
            vertices[boundary],
            solid.space,
            min_dihedral=options.min_dihedral,
            rounds=options.rounds,
        )[used]
    return SolidMesh(vertices, tets, faces, changes)


def _reluctance(
    field: Field | VertexField, occupancy: Bool[np.ndarray, "T"], mu: float
) -> Float[np.ndarray, "T"]:
    """What it costs to change the occupancy of each tet: more, the further it lies from the surface.

    The unit is the mean displacement of surface tets; where displacements are known at vertices alone, every
    tet counts as one away. Emptying costs a multiple: a tet filled for nothing is drawn to the surface with
    its vertices, but where one is missing nothing else represents the shape, and its pieces may fall apart.
    """
    far = np.ones(len(occupancy))
    if isinstance(field, Field):
        far = np.minimum(np.linalg.norm(field.displacement.astype(np.float64), axis=1) / (mu or 1.0), _FAR)
    return np.where(occupancy, _EMPTYING * (far + 0.5), far + 0.1)


def _displacement_at(
    blend: sparse.csr_array, field: Field | VertexField, operator: sparse.csr_array
) -> Float[np.ndarray, "N 3"]:
    """Displacement of means of the grid's vertices: by Eq. 3, or as the field itself has it.

    Args:
        blend: (N, G) the means; vertices beyond those of the grid, which are the collar's, are not displaced.
    """
    means = blend[:, : operator.shape[0]]
    if isinstance(field, VertexField):
        return means @ field.vertex_displacement.astype(np.float64)
    return (means @ operator) @ field.displacement.astype(np.float64)
