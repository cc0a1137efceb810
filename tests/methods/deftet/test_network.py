"""DefTet's surface network: its graphs, and its effect on the TetGAN below it."""

import numpy as np
import pytest
import torch

from tetgan.fields.field import Field, VertexField
from tetgan.geometry.adjacency import boundary_faces
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.deftet.network import DeftetGenerator, SurfaceNetwork, surface_graph
from tetgan.methods.deftet.options import DeftetOptions
from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.methods.tetgan.options import TetganOptions
from tetgan.models.files import load_generator, load_options, save_generator
from tetgan.models.sampling import generate_fields, reconstruct_fields

CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TETGAN = TetganOptions(grid="smoke", latent="tet", width=4, code=6)
OPTIONS = DeftetOptions(kind="deftet", grid="smoke", of="full", width=8, blocks=2)


def build(hierarchy, seed: int = 0) -> DeftetGenerator:
    torch.manual_seed(seed)
    model = DeftetGenerator(OPTIONS, hierarchy, TetganGenerator(TETGAN, hierarchy))
    model.unit.fill_(0.05)
    return model


def random_occupancy(hierarchy, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random(len(hierarchy.finest.tets)) < 0.3


def test_the_graph_of_one_tet():
    graph = surface_graph(np.array([True]), TetGrid(CORNER, np.array([[0, 1, 2, 3]])))
    assert graph.vertices.tolist() == [0, 1, 2, 3]
    # Each vertex has the other three around it.
    np.testing.assert_allclose(graph.around.toarray(), (1 - np.eye(4)) / 3)
    np.testing.assert_allclose(graph.features[:, :3], 2 * CORNER - 1)
    # The three sides at the corner, half a square each, and for the others the slanted one too.
    outward = graph.features[:, 3:]
    np.testing.assert_allclose(outward[0], -np.ones(3) / np.sqrt(3), atol=1e-6)
    np.testing.assert_allclose(outward[1], [1, 0, 0], atol=1e-6)


def test_graphs_hold_the_boundary_and_nothing_else():
    hierarchy = build_hierarchy(1, 1)
    occupancy = random_occupancy(hierarchy)
    graph = surface_graph(occupancy, hierarchy.finest)
    faces = boundary_faces(hierarchy.finest.tets[occupancy])
    np.testing.assert_array_equal(graph.vertices, np.unique(faces))
    place = {vertex: number for number, vertex in enumerate(graph.vertices.tolist())}
    around = {number: set() for number in place.values()}
    for face in faces.tolist():
        for vertex in face:
            around[place[vertex]] |= {place[other] for other in face} - {place[vertex]}
    for number, others in around.items():
        row = graph.around[[number]].toarray()[0]
        assert set(np.flatnonzero(row)) == others
        np.testing.assert_allclose(row[list(others)], 1 / len(others))


def test_graphs_of_a_batch_do_not_mix():
    hierarchy = build_hierarchy(1, 1)
    graphs = [surface_graph(random_occupancy(hierarchy, seed), hierarchy.finest) for seed in range(3)]
    network = SurfaceNetwork(8, 2)
    together = network(graphs).split([len(graph.vertices) for graph in graphs])
    for part, graph in zip(together, graphs, strict=True):
        torch.testing.assert_close(part, network([graph]), rtol=1e-5, atol=1e-6)


def test_the_size_of_the_network():
    width, blocks = 64, 3
    count = sum(p.numel() for p in SurfaceNetwork(width, blocks).parameters())
    convolution = lambda inputs: 2 * inputs * width + width  # noqa: E731
    assert count == convolution(6) + 2 * blocks * convolution(width) + 3 * width + 3


def test_occupancy_and_codes_are_those_of_the_other_model(store):
    model = build(store.hierarchy)
    fields = generate_fields(model, store, 3, seed=1)
    others = generate_fields(model.of, store, 3, seed=1)
    for field, other in zip(fields, others, strict=True):
        assert isinstance(field, VertexField) and isinstance(other, Field)
        np.testing.assert_array_equal(field.occupancy, other.occupancy)
    pairs = (reconstruct_fields(each, store, store.ids("validation")) for each in (model, model.of))
    for (one, _, iou), (other, _, other_iou) in zip(*pairs, strict=True):
        assert (one, iou) == (other, other_iou)


def test_only_the_boundary_moves(store):
    model = build(store.hierarchy)
    occupancy = random_occupancy(store.hierarchy)
    nothing = Field(occupancy, np.zeros((len(occupancy), 3), dtype=np.float32))
    moved = np.flatnonzero(model.meshed(nothing).vertex_displacement.any(axis=1))
    graph = surface_graph(occupancy, store.hierarchy.finest)
    np.testing.assert_array_equal(moved, graph.vertices)
    expected = 0.05 * model.network([graph]).detach().numpy()
    np.testing.assert_allclose(model.meshed(nothing).vertex_displacement[graph.vertices], expected)


@pytest.mark.parametrize("full", [False, True])
def test_an_empty_and_a_full_cube_are_no_trouble(store, full):
    occupancy = np.full(len(store.hierarchy.finest.tets), full)
    field = build(store.hierarchy).meshed(Field(occupancy, np.zeros((len(occupancy), 3), dtype=np.float32)))
    assert bool(field.vertex_displacement.any()) == full


def test_a_saved_model_holds_both(store, tmp_path):
    model = build(store.hierarchy)
    save_generator(tmp_path, model, OPTIONS, store.hierarchy, of={"model": TETGAN.model_dump(mode="json")})
    assert load_options(tmp_path) == OPTIONS
    loaded = load_generator(tmp_path, store.hierarchy)
    for one, other in zip(
        *(generate_fields(each, store, 2, seed=0) for each in (model, loaded)), strict=True
    ):
        np.testing.assert_array_equal(one.occupancy, other.occupancy)
        np.testing.assert_array_equal(one.vertex_displacement, other.vertex_displacement)
