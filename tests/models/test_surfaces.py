"""Sampling of models of implicit surfaces, with made-up ones: a sphere whose radius is the code."""

import json

import numpy as np
import pandas as pd
import pytest
import torch
import trimesh

from tetgan.fields.options import PointOptions, VoxelOptions
from tetgan.fields.samplings import PointStore, VoxelStore, extract_samplings, index_samplings
from tetgan.meshing.options import MeshingOptions
from tetgan.methods.occnet.options import OccNetOptions
from tetgan.methods.shapegan.options import ShapeGanOptions
from tetgan.methods.shapegan_vae.options import ShapeGanVaeOptions
from tetgan.models import samples
from tetgan.models.files import build_surface_model, save_generator
from tetgan.models.generator import ImplicitGenerator, VoxelGenerator
from tetgan.models.samples import sample_model
from tetgan.models.surfaces import (
    Extraction,
    decode_surface,
    extraction_of,
    generate_surfaces,
    reconstruct_surfaces,
)
from tetgan.shapes.archive import write_meshes

GRID = Extraction(8, 2, 1.1)
RADII = {"a": 0.2, "b": 0.3, "c": 0.45}


class Sphere(ImplicitGenerator):
    """Radius minus distance from the centre; encodes points by the farthest one inside."""

    def __init__(self, has_encoder=True):
        super().__init__()
        self.has_encoder = has_encoder

    @property
    def latent_shape(self):
        return (1,)

    @property
    def level(self):
        return 0.05

    def draw_noise(self, generator):
        return torch.rand(1, generator=generator)

    def from_noise(self, noise):
        return 0.2 + 0.2 * noise

    def encode(self, data):
        radius = (data[..., :3] - 0.5).norm(dim=-1)
        return (radius * data[..., 3]).amax(dim=1, keepdim=True)

    def value(self, latent, points):
        return latent + self.level - (points - 0.5).norm(dim=-1)


class VoxelSphere(VoxelGenerator):
    """The same on 32³ voxels; encodes the distance at the centre."""

    @property
    def latent_shape(self):
        return (1,)

    def encode(self, data):
        raise AssertionError("never asked")

    def voxels(self, latent):
        ticks = (torch.arange(32) + 0.5) / 32 - 0.5
        radius = torch.stack(torch.meshgrid(ticks, ticks, ticks, indexing="ij")).norm(dim=0)
        return (radius - latent.view(-1, 1, 1, 1)).clamp(-0.1, 0.1)


def index(folder, options):
    """Three balls, the last for validation."""
    meshes = []
    for shape_id, radius in RADII.items():
        mesh = trimesh.creation.icosphere(subdivisions=4, radius=radius)
        meshes.append((shape_id, np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64)))
    write_meshes(folder / "1.zip", meshes, [])
    (folder / "catalogue.csv").write_text("id,split\na,train\nb,train\nc,validation\n")
    extract_samplings(folder / "1.zip", folder / "1.zarr.zip", options)
    index_samplings([folder / "1.zarr.zip"], folder / "catalogue.csv", options, folder / "index.json")
    return folder / "index.json"


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    return index(tmp_path_factory.mktemp("points"), PointOptions(kind="points", count=4000))


@pytest.fixture(scope="module")
def voxels(tmp_path_factory):
    return index(tmp_path_factory.mktemp("voxels"), VoxelOptions(kind="voxels", resolution=32))


def radius_of(surface):
    return np.linalg.norm(surface.vertices - 0.5, axis=1)


@pytest.mark.parametrize("model", [Sphere(), VoxelSphere()], ids=["points", "voxels"])
def test_the_code_becomes_the_radius(model):
    surface = decode_surface(model, torch.tensor([[0.3]]), GRID)
    assert np.abs(radius_of(surface) - 0.3).max() < 1e-3  # 1.1/32 squared, over 8 · 0.3


def test_an_empty_draw_has_no_faces():
    assert len(decode_surface(Sphere(), torch.tensor([[-1.0]]), GRID).faces) == 0


def test_samples_depend_on_the_seed_alone():
    one, again = (list(generate_surfaces(Sphere(), GRID, 3, seed=1)) for _ in range(2))
    assert all(np.array_equal(a.vertices, b.vertices) for a, b in zip(one, again, strict=True))
    (first,) = generate_surfaces(Sphere(), GRID, 1, seed=1)
    assert np.array_equal(first.vertices, one[0].vertices)
    (other,) = generate_surfaces(Sphere(), GRID, 1, seed=2)
    assert not np.array_equal(other.vertices, first.vertices)


def test_points_are_encoded_and_decoded_again(points):
    store = PointStore.open(points)
    found = list(reconstruct_surfaces(Sphere(), GRID, store, ["a", "c"]))
    assert [shape_id for shape_id, _, _ in found] == ["a", "c"]
    for shape_id, surface, iou in found:
        # The farthest of the encoded points inside is a little nearer than the surface.
        assert RADII[shape_id] - 0.03 < radius_of(surface).mean() < RADII[shape_id] + 1e-3
        assert 0.7 < iou <= 1


def test_a_model_without_an_encoder_reconstructs_nothing(points):
    store = PointStore.open(points)
    assert list(reconstruct_surfaces(Sphere(has_encoder=False), GRID, store, ["a"])) == []


def test_the_grid_follows_the_options(points, voxels):
    on_points, on_voxels = PointStore.open(points), VoxelStore.open(voxels)
    occnet, gan, vae = map(build_surface_model, CASES.values())
    assert extraction_of(occnet, on_points) == (8, 1, 1.1)
    assert extraction_of(gan, on_voxels) == (8, 0, 1.0)
    assert extraction_of(vae, on_voxels) is None


CASES = {
    "occnet": OccNetOptions(kind="occnet", mise_start=8, mise_steps=1),
    "shapegan-gan": ShapeGanOptions(kind="shapegan-gan", resolution=8),
    "shapegan-vae": ShapeGanVaeOptions(kind="shapegan-vae"),
}


@pytest.mark.parametrize("kind", CASES)
def test_every_baseline_leaves_a_folder_that_evaluation_reads(kind, points, voxels, tmp_path):
    torch.manual_seed(0)
    save_generator(tmp_path / "model", build_surface_model(CASES[kind]), CASES[kind])
    where = points if kind == "occnet" else voxels
    sample_model(
        tmp_path / "model", where, tmp_path / "samples", count=2, options=MeshingOptions.parse({}), seed=0
    )
    table = pd.read_csv(tmp_path / "samples/none/certificate.csv", dtype={"id": str})
    generated, reconstructed = (table[table["set"] == name] for name in ("generated", "reconstructed"))
    assert generated["id"].tolist() == ["0000", "0001"]
    assert reconstructed["id"].tolist() == ([] if kind == "shapegan-gan" else ["c"])
    assert {"faces", "volume", "components", "manifold_edges"} <= set(table)
    for _, row in table.iterrows():
        file = tmp_path / "samples/none" / row["set"] / f"{row['id']}.ply"
        assert file.exists() == (row["faces"] > 0)
    assert json.loads((tmp_path / "samples/about.json").read_text()) == {
        "method": kind,
        "train_minutes": None,
    }
    assert not (tmp_path / "samples/wls").exists()


def test_a_sphere_goes_through_the_stage(points, tmp_path, monkeypatch):
    save_generator(tmp_path / "model", Sphere(), CASES["occnet"])
    monkeypatch.setattr(samples, "load_surface_model", lambda _: Sphere())
    sample_model(
        tmp_path / "model", points, tmp_path / "samples", count=3, options=MeshingOptions.parse({}), seed=0
    )
    table = pd.read_csv(tmp_path / "samples/none/certificate.csv", dtype={"id": str})
    assert (table["faces"] > 0).all()
    assert (table["manifold_edges"] == 1).all()
    reconstructed = trimesh.load_mesh(tmp_path / "samples/none/reconstructed/c.ply")
    assert reconstructed.is_watertight
    assert np.ptp(reconstructed.vertices, axis=0) == pytest.approx(3 * [0.9], abs=0.06)
    assert table.loc[table["id"] == "c", "iou"].item() > 0.7
