"""Simple solids, meshes and fields of box-shaped seats, and a model that has memorised them."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from tetgan.fields.extraction import extract_field
from tetgan.fields.store import FieldStore, index_fields, write_shard
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.grids.options import GridOptions
from tetgan.methods.pca.network import PcaGenerator
from tetgan.methods.pca.options import PcaOptions
from tetgan.models.files import save_generator
from tetgan.shapes.archive import write_meshes
from tetgan.studies.resolution.torus import Torus

Mesh = tuple[np.ndarray, np.ndarray]
HIERARCHY = build_hierarchy(1, 2)
TRAIN = 8


def boxes(*bounds: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Mesh:
    mesh = trimesh.util.concatenate([trimesh.creation.box(bounds=pair) for pair in bounds])
    return np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)


def seat(width: float, *, base: float = 0.0, back: bool = False) -> Mesh:
    """A block of a width, with or without a back above it."""
    low, high = 0.5 - width / 2, 0.5 + width / 2
    parts = [((low, base, 0.1), (high, 0.5, 0.9))]
    if back:
        parts.append(((low, 0.5, 0.1), (high, 1.0, 0.35)))
    return boxes(*parts)


# The last five are for validation: the first two differ in the back alone, the next two in their width, and
# the last has nothing in common with the others but its middle.
MESHES: dict[str, Mesh] = {
    **{f"train-{i}": seat(0.3 + 0.08 * i, base=0.04 * (i % 3), back=i % 2 == 0) for i in range(TRAIN)},
    "wide-back": seat(0.9, back=True),
    "wide": seat(0.9),
    "middle": seat(0.6),
    "narrow": seat(0.35),
    "pole": boxes(((0.35, 0.0, 0.35), (0.65, 1.0, 0.65))),
}


@pytest.fixture(scope="session")
def project(tmp_path_factory) -> Path:
    """Folder with meshes.zip, catalogue.csv and index.json."""
    folder = tmp_path_factory.mktemp("project")
    write_meshes(folder / "meshes.zip", ((name, *mesh) for name, mesh in MESHES.items()), [])
    rows = [f"{name},{'train' if name.startswith('train') else 'validation'}" for name in MESHES]
    (folder / "catalogue.csv").write_text("\n".join(["id,split", *rows]) + "\n")
    fields = (extract_field(*mesh, HIERARCHY.finest) for mesh in MESHES.values())
    write_shard(folder / "1.zarr.zip", list(MESHES), fields, HIERARCHY.digest)
    grid = GridOptions.parse({"cells": 1, "depth": 2})
    index_fields([folder / "1.zarr.zip"], folder / "catalogue.csv", grid, folder / "index.json")
    return folder


@pytest.fixture(scope="session")
def store(project) -> FieldStore:
    return FieldStore.open(project / "index.json")


@pytest.fixture(scope="session")
def model(project, store) -> Path:
    """PCA with as many components as there are shapes, fitted to all of them: it decodes what it encodes."""
    options = PcaOptions(kind="pca", grid="tiny", components=len(MESHES))
    generator = PcaGenerator(options, store.hierarchy)
    tensor = store.tensor(list(MESHES))
    generator.fit(lambda part: tensor[:, part])
    save_generator(project / "model", generator, options, store.hierarchy)
    return project / "model"


@pytest.fixture(scope="session")
def torus():
    return Torus(major=0.3, minor=0.12, axis=(1.0, 2.0, 3.0))


@pytest.fixture(scope="session")
def ball():
    """Vertices and faces of a ball of radius 0.4 about the middle of the cube."""
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=0.4)
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64)


@pytest.fixture(scope="session")
def cube():
    """Vertices and faces of the unit cube, two triangles a side."""
    mesh = trimesh.creation.box((1, 1, 1))
    return np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64)
