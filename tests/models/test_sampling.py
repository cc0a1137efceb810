"""Fields out of models, and models to disk and back."""

import numpy as np
import pytest
import torch

from tetgan.errors import UserError
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.pca.options import PcaOptions
from tetgan.methods.representation.options import RepresentationOptions
from tetgan.methods.tetgan.options import TetganOptions
from tetgan.models.files import WEIGHTS, build_generator, load_generator, save_generator
from tetgan.models.iou import occupancy_iou
from tetgan.models.sampling import draw_latents, generate_fields, reconstruct_fields

OPTIONS = [
    TetganOptions(grid="smoke", latent="global", width=4, code=6),
    TetganOptions(grid="smoke", latent="tet", width=4, code=6, pool="mean", upsample="copy"),
    TetganOptions(grid="smoke", latent="conv", width=4, code=6, convolution="shared", displacement=False),
    PcaOptions(kind="pca", grid="smoke", components=3),
    RepresentationOptions(kind="representation", grid="smoke"),
]


def occupancies(fields) -> np.ndarray:
    return np.stack([field.occupancy for field in fields])


@pytest.mark.parametrize("options", OPTIONS, ids=lambda o: f"{o.kind}-{getattr(o, 'latent', '')}")
def test_a_saved_model_decodes_as_before(store, tmp_path, options):
    torch.manual_seed(0)
    generator = build_generator(options, store.hierarchy)
    save_generator(tmp_path, generator, options, store.hierarchy, seed=3)
    loaded = load_generator(tmp_path, store.hierarchy)
    latent = torch.cat(list(draw_latents(generator, 2, seed=0, device="cpu")))
    assert torch.equal(loaded.decode(latent), generator.decode(latent))


def test_samples_depend_on_the_seed_alone(store):
    torch.manual_seed(0)
    generator = build_generator(OPTIONS[0], store.hierarchy)
    five = occupancies(generate_fields(generator, store, 5, seed=1, batch_size=2))
    assert np.array_equal(occupancies(generate_fields(generator, store, 5, seed=1, batch_size=5)), five)
    assert not np.array_equal(occupancies(generate_fields(generator, store, 5, seed=2)), five)


@pytest.mark.parametrize("prior", ["normal", "fitted"])
def test_batches_of_the_prior_have_the_numbers_of_single_draws(store, prior):
    generator = build_generator(OPTIONS[1].model_copy(update={"prior": prior}), store.hierarchy)
    if generator.prior is not None:
        codes = torch.randn(9, *generator.latent_shape, generator=torch.Generator().manual_seed(1))
        generator.prior.fit(2 + codes, codes.square())
    draws = torch.Generator().manual_seed(3)
    single = torch.cat([generator.sample_latent(1, draws) for _ in range(7)])
    for batch_size in (1, 3, 7):
        batches = list(draw_latents(generator, 7, seed=3, batch_size=batch_size, device="cpu"))
        assert max(map(len, batches)) == batch_size
        assert not torch.is_inference_mode_enabled()
        # Of a fitted prior a product of matrices, rounded by the size of the batch.
        torch.testing.assert_close(torch.cat(batches), single, rtol=0, atol=1e-5 if prior == "fitted" else 0)


def test_displacements_come_back_in_cube_sides(store):
    generator = build_generator(PcaOptions(kind="pca", grid="smoke", components=5), store.hierarchy)
    tensor = store.tensor(store.ids("train"))
    generator.fit(lambda part: tensor[:, part])
    for shape_id, field, iou in reconstruct_fields(generator, store, store.ids("train"), batch_size=4):
        original = store.read(shape_id)
        assert iou == 1
        np.testing.assert_allclose(field.displacement, original.displacement, atol=1e-4)


def test_the_representation_gives_the_fields_themselves(store):
    generator = build_generator(OPTIONS[-1], store.hierarchy)
    for shape_id, field, iou in reconstruct_fields(generator, store, store.ids("validation")):
        assert iou == 1
        assert np.array_equal(field.displacement, store.read(shape_id).displacement)
    once = occupancies(generate_fields(generator, store, 6, seed=0))
    train = occupancies(store.read(shape_id) for shape_id in store.ids("train"))
    assert np.array_equal(np.unique(once, axis=0), np.unique(train, axis=0))
    assert np.array_equal(occupancies(generate_fields(generator, store, 8, seed=0))[6:], once[:2])


def test_a_model_of_another_grid_or_no_model_is_refused(store, tmp_path):
    generator = build_generator(OPTIONS[0], store.hierarchy)
    save_generator(tmp_path, generator, OPTIONS[0], store.hierarchy)
    with pytest.raises(UserError, match="another grid"):
        load_generator(tmp_path, build_hierarchy(1, 0))
    (tmp_path / WEIGHTS).write_bytes(b"torn")
    with pytest.raises(UserError, match="train it first"):
        load_generator(tmp_path, store.hierarchy)


def test_iou_by_hand():
    predicted = np.array([[True, True, False], [False, False, False]])
    true = np.array([[True, False, True], [False, False, False]])
    assert occupancy_iou(predicted, true).tolist() == [1 / 3, 1.0]
