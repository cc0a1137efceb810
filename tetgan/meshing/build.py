"""From a field to a solid mesh."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse

from tetgan.fields.field import Field, VertexField
from tetgan.geometry.adjacency import boundary_faces
from tetgan.grids.grid import TetGrid
from tetgan.meshing.agreement import make_planes_agree
from tetgan.meshing.background import lattice_around, subdivisions
from tetgan.meshing.filtering import filter_occupancy
from tetgan.meshing.isosurface import Fit, cut_solid, drop_small_pieces
from tetgan.meshing.mesh_surface import Triangles, cut_surface
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.planes import planes_of_field, typical_edge
from tetgan.meshing.smoothing import smooth_vertices
from tetgan.solids.solid import SolidMesh

_MULTIPLE = 4  # of which the lattice's cells are one, to be coarser by two levels away from the surface


def build_solid(
    field: Field | VertexField,
    grid: TetGrid,
    operator: sparse.csr_array,
    mu: float,
    options: MeshingOptions,
    *,
    smoothing: bool,
) -> SolidMesh:
    """Filter (Eq. 5), then make a mesh of the surface that the field holds and, if asked, smooth it (Eq. 4).

    In mode `paper` the occupied tets are the mesh, and their boundary vertices are displaced (Eq. 3): moving
    the others too inverts more tets, and gains the surface nothing. Even so a few per cent of the tets may
    come out inverted, and boundary edges may have four faces; `quality_record` counts them.

    In mode `solid` a body-centred cubic lattice is cut where the surface is; see docs/solids.md.

    Args:
        grid: the finest grid of the hierarchy, which the field lives on.
        operator: `vertex_operator(grid)`, made once for many fields.
        mu: the data set's mean displacement of surface tets.

    Returns:
        The solid; without tets where nothing is occupied.
    """
    occupancy = filter_occupancy(field, grid.neighbors, mu, options.gamma)
    if options.mode == "solid":
        return _valid_solid(field, grid, occupancy, options, smoothing=smoothing)
    displacement = (
        field.vertex_displacement if isinstance(field, VertexField) else operator @ field.displacement
    )
    return _faithful_solid(grid, occupancy, displacement, options.beta if smoothing else None)


def _faithful_solid(
    grid: TetGrid,
    occupancy: Bool[np.ndarray, "T"],
    displacement: Float[np.ndarray, "V 3"],
    beta: float | None,
) -> SolidMesh:
    """The paper's mesh; smoothed where there is a `beta`."""
    used, compact = np.unique(grid.tets[occupancy], return_inverse=True)
    tets = compact.reshape(-1, 4)
    faces = boundary_faces(tets)
    vertices, displacement = grid.vertices[used], displacement[used].astype(np.float64)
    boundary = np.unique(faces)
    vertices[boundary] += displacement[boundary]
    if beta is not None:
        vertices = smooth_vertices(vertices, displacement, faces, beta)
    return SolidMesh(vertices, tets, faces)


def _valid_solid(
    field: Field | VertexField,
    grid: TetGrid,
    occupancy: Bool[np.ndarray, "T"],
    options: MeshingOptions,
    *,
    smoothing: bool,
) -> SolidMesh:
    """The solid cut from a lattice."""
    if not occupancy.any():
        return SolidMesh.empty()
    cells = lattice_cells(len(grid.tets), options.resolution)
    fit = Fit(options.min_dihedral, options.rounds, options.beta if smoothing else None)
    if isinstance(field, VertexField):
        faithful = _faithful_solid(grid, occupancy, field.vertex_displacement, None)
        surface = Triangles(faithful.vertices.clip(0, 1), faithful.faces)
        depth = subdivisions(cells)
        solid = cut_surface(surface, cells >> depth, depth, fit, options.interior)
    else:
        planes = planes_of_field(field, grid, occupancy)
        neighbors = _neighbors_among(grid, occupancy == field.occupancy)
        planes = make_planes_agree(planes, neighbors, typical_edge(grid))
        lattice, distances = lattice_around(planes, _between(grid, occupancy), cells, options.interior)
        solid = cut_solid(lattice, distances, planes, 1 / cells, fit)
    return drop_small_pieces(solid, options.min_component)


def lattice_cells(tets: int, resolution: float) -> int:
    """Cells along the cube of the lattice that solids are cut from, for a grid of some number of tets."""
    return _MULTIPLE * max(1, round(resolution * (tets / 12) ** (1 / 3) / _MULTIPLE))


def _neighbors_among(grid: TetGrid, kept: Bool[np.ndarray, "T"]) -> Int[np.ndarray, "K 4"]:
    """The neighbours of some tets among themselves, numbered as they come; -1 where there is none."""
    number = np.append(np.where(kept, np.cumsum(kept) - 1, -1), -1)  # a missing neighbour reads the last
    return number[grid.neighbors[kept]]


def _between(grid: TetGrid, occupancy: Bool[np.ndarray, "T"]) -> Float[np.ndarray, "C 3"]:
    """Points between occupied tets and empty ones: the surface is near, or should be."""
    occupied, slots = np.nonzero(occupancy[:, None] & (grid.neighbors >= 0))
    other = grid.neighbors[occupied, slots]
    change = ~occupancy[other]
    return (grid.centroids[occupied[change]] + grid.centroids[other[change]]) / 2
