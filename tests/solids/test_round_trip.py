"""Ground-truth fields of analytic shapes come back as those shapes."""

import igl
import numpy as np
import pytest
import trimesh

from tetgan.fields.extraction import extract_field
from tetgan.fields.field import Field, surface_tets, vertex_operator
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.solids.record import quality_record

CELLS = 2
PAPER = MeshingOptions(mode="paper")
SHAPES = {
    "ball": trimesh.creation.icosphere(subdivisions=4, radius=0.4),
    "torus": trimesh.creation.torus(0.33, 0.12, major_sections=96, minor_sections=48),
    "box": trimesh.creation.box((0.83, 0.57, 0.41)),
}
CURVATURE = {"ball": 1 / 0.4, "torus": 1 / 0.12}


class Trip:
    """A shape there and back on the grid of a depth, its surface distances and its certificate."""

    def __init__(self, shape, depth, smoothing):
        original = SHAPES[shape].copy().apply_translation([0.5] * 3)
        vertices, faces = np.array(original.vertices), np.array(original.faces, dtype=np.int64)
        grid = build_hierarchy(CELLS, depth).finest
        operator = vertex_operator(grid)
        field = extract_field(vertices, faces, grid)
        lengths = np.linalg.norm(field.displacement, axis=1)
        mu = float(lengths[surface_tets(field.occupancy, grid.neighbors)].mean())
        self.mesh = build_solid(field, grid, operator, mu, PAPER, smoothing=smoothing)
        still = Field(field.occupancy, np.zeros_like(field.displacement))
        self.blocky = build_solid(still, grid, operator, mu, PAPER, smoothing=False)
        self.surface = trimesh.Trimesh(self.mesh.vertices, self.mesh.faces, process=False)
        there, back = sample(self.surface), sample(original)
        self.distance = (distance_to(there, original).mean() + distance_to(back, self.surface).mean()) / 2
        self.vertex_distance, self.blocky_vertex_distance = (
            distance_to(mesh.vertices[np.unique(mesh.faces)], original).mean()
            for mesh in (self.mesh, self.blocky)
        )
        self.volume_ratio = quality_record(self.mesh)["volume"] / original.volume


def sample(mesh):
    return trimesh.sample.sample_surface(mesh, 2000, seed=0)[0]


def distance_to(points, mesh):
    squared, _, _ = igl.point_mesh_squared_distance(
        np.array(points), np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)
    )
    return np.sqrt(squared)


@pytest.fixture(scope="module")
def trips():
    return {
        (shape, depth, smoothing): Trip(shape, depth, smoothing)
        for shape in SHAPES
        for depth in (2, 3)
        for smoothing in (False, True)
    }


@pytest.mark.parametrize("depth", [2, 3])
@pytest.mark.parametrize("shape", CURVATURE)
def test_curved_shapes_come_back_to_second_order(trips, shape, depth):
    # A chord as long as a cell side h sags by h²κ/8 below a surface of curvature κ, and averaging the
    # displacements of centroids up to h away from the vertex (Eq. 3) loses as much again.
    h = 1 / (CELLS * 2**depth)
    assert trips[shape, depth, False].distance < h**2 * CURVATURE[shape] / 4


@pytest.mark.parametrize("shape", CURVATURE)
def test_halving_the_cells_quarters_the_error(trips, shape):
    # Second order predicts 4; the torus is barely resolved at depth 2, and sampling adds a few per cent.
    assert trips[shape, 2, False].distance / trips[shape, 3, False].distance > 3.3


def test_flat_faces_come_back_but_for_the_edges(trips):
    # A linear distance survives averaging, so flat faces return almost exactly; sharp edges are cut off by a
    # share of a cell side h, along strips about h wide that make up less than half of the box's surface.
    for depth in (2, 3):
        assert trips["box", depth, False].distance < 1 / (CELLS * 2**depth) / 10
    assert trips["box", 2, False].distance / trips["box", 3, False].distance > 2


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("depth", [2, 3])
def test_displacement_brings_boundary_vertices_closer(trips, shape, depth):
    trip = trips[shape, depth, False]
    assert trip.vertex_distance < trip.blocky_vertex_distance / 2


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("smoothing", [False, True])
def test_volumes_come_near(trips, shape, smoothing):
    # About area times distance is lost; for the torus, of its volume, 2/0.12 times the distance.
    coarse, fine = (trips[shape, depth, smoothing].volume_ratio for depth in (2, 3))
    assert abs(1 - fine) < abs(1 - coarse)
    assert abs(1 - fine) < (0.1 if smoothing else 0.06)


@pytest.mark.parametrize("shape", SHAPES)
def test_smoothing_shrinks_and_keeps_the_surface(trips, shape):
    rough, smooth = trips[shape, 3, False], trips[shape, 3, True]
    np.testing.assert_array_equal(rough.mesh.faces, smooth.mesh.faces)
    assert smooth.surface.area < rough.surface.area
    assert smooth.distance < 0.0625 / 10


@pytest.mark.parametrize("shape", ["ball", "torus"])
def test_surfaces_are_closed(trips, shape):
    surface = trips[shape, 3, False].surface
    assert surface.is_watertight
    assert surface.euler_number == {"ball": 2, "torus": 0}[shape]


@pytest.mark.parametrize("shape", SHAPES)
def test_displacement_inverts_a_few_tets_as_the_papers_meshes_do(trips, shape):
    # Measured before: 0 to 3.4 % with boundary vertices displaced. A method that certifies its meshes will
    # have its own mode and its own test; this one pins what the paper's does.
    record = quality_record(trips[shape, 3, False].mesh)
    assert record["inverted_tets"] <= 0.034 * record["tets"]
