"""Packed models, and the pretrained ones that come with the package."""

import json

import numpy as np
import pandas as pd
import pytest
import torch
from safetensors.torch import load_file

from tetgan.errors import UserError
from tetgan.fields.store import FieldStore
from tetgan.meshing.options import MeshingOptions
from tetgan.methods.representation.options import RepresentationOptions
from tetgan.methods.tetgan.options import TetganOptions
from tetgan.models.files import OPTIONS, WEIGHTS, build_generator, load_generator, save_generator
from tetgan.models.pack import INDEX, PRETRAINED, find_model, index_beside, pack_model
from tetgan.models.samples import sample_model
from tetgan.models.sampling import generate_fields

SHIPPED = sorted(path.parent for path in PRETRAINED.glob(f"*/{OPTIONS}"))
MOST_BYTES = 12 * 10**6


@pytest.fixture
def trained(store, tmp_path):
    """A model with a prior of its own, its folder, and the index of its fields."""
    torch.manual_seed(0)
    options = TetganOptions(grid="smoke", latent="tet", width=4, code=6, prior="fitted")
    generator = build_generator(options, store.hierarchy)
    save_generator(tmp_path / "model", generator, options, store.hierarchy, seed=3)
    return generator, tmp_path / "model", store._path


def test_a_packed_model_samples_what_the_model_does(store, trained, tmp_path):
    generator, model, index = trained
    pack_model(model, index, tmp_path / "packed")
    packed = FieldStore.open(index_beside(tmp_path / "packed"))
    assert packed.ids("train") == packed.ids("validation") == []
    assert (packed.mu, packed.max_displacement) == (store.mu, store.max_displacement)
    loaded = load_generator(tmp_path / "packed", packed.hierarchy)
    ours, theirs = (
        list(generate_fields(each, of, 3, seed=0)) for each, of in ((generator, store), (loaded, packed))
    )
    longest = max(np.abs(field.displacement).max() for field in ours)
    for one, other in zip(ours, theirs, strict=True):
        assert (one.occupancy != other.occupancy).mean() < 0.02  # a logit near zero may round over it
        np.testing.assert_allclose(one.displacement, other.displacement, atol=0.02 * longest)


def test_it_is_half_as_large_and_says_what_the_model_said(trained, tmp_path):
    _, model, index = trained
    pack_model(model, index, tmp_path / "packed")
    assert sorted(path.name for path in (tmp_path / "packed").iterdir()) == sorted([INDEX, OPTIONS, WEIGHTS])
    assert json.loads((tmp_path / "packed" / OPTIONS).read_text()) == json.loads(
        (model / OPTIONS).read_text()
    )
    weights = load_file(tmp_path / "packed" / WEIGHTS)
    assert {value.dtype for value in weights.values()} == {torch.float16}
    assert (tmp_path / "packed" / WEIGHTS).stat().st_size < 0.6 * (model / WEIGHTS).stat().st_size


def test_samples_need_no_index_beside_a_packed_model(trained, tmp_path):
    _, model, index = trained
    pack_model(model, index, tmp_path / "packed")
    packed = tmp_path / "packed"
    sample_model(packed, index_beside(packed), tmp_path / "out", count=2, options=MeshingOptions(), seed=0)
    rows = pd.read_csv(tmp_path / "out/none/certificate.csv")
    assert list(rows["set"]) == ["generated", "generated"]
    with pytest.raises(UserError, match="not packed; name with --index"):
        index_beside(model)


def test_what_cannot_be_packed_is_refused(store, trained, tmp_path):
    generator, model, index = trained
    options = RepresentationOptions(kind="representation", grid="smoke")
    save_generator(tmp_path / "fields", build_generator(options, store.hierarchy), options, store.hierarchy)
    with pytest.raises(UserError, match="a representation has no weights"):
        pack_model(tmp_path / "fields", index, tmp_path / "packed")
    with pytest.raises(UserError, match="not a trained model"):
        pack_model(tmp_path / "absent", index, tmp_path / "packed")
    with torch.no_grad():
        next(generator.parameters())[...] = 1e6
    save_generator(model, generator, TetganOptions(**generator_options(model)), store.hierarchy)
    with pytest.raises(UserError, match="too large for half precision"):
        pack_model(model, index, tmp_path / "packed")
    assert not (tmp_path / "packed").exists()
    with pytest.raises(UserError, match="model: is there already; name a new folder"):
        pack_model(model, index, model)


def generator_options(model):
    return json.loads((model / OPTIONS).read_text())["model"]


def test_a_folder_comes_before_a_pretrained_model(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = type(tmp_path)("chair")
    assert find_model(name) == PRETRAINED / "chair"
    (tmp_path / "chair").mkdir()
    assert find_model(name) == name
    with pytest.raises(
        UserError, match=r"no folder of a trained model, and no pretrained one \(there are: chair"
    ):
        find_model(type(tmp_path)("somewhere/chair"))


@pytest.mark.parametrize("folder", SHIPPED, ids=lambda folder: folder.name)
def test_a_pretrained_model_gives_valid_solids(folder, tmp_path):
    assert sum(path.stat().st_size for path in folder.iterdir()) < MOST_BYTES
    card = (folder / "README.md").read_text()
    for heading in ("## Data", "## Licence", "## Training", "## Numbers", "## Limits"):
        assert heading in card
    sample_model(folder, index_beside(folder), tmp_path / "out", count=3, options=MeshingOptions(), seed=0)
    for smoothing in ("none", "wls"):
        rows = pd.read_csv(tmp_path / "out" / smoothing / "certificate.csv")
        assert rows["valid"].all()
        assert (rows["tets"] > 100).all()
