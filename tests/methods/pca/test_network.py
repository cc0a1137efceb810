"""PCA against numpy's singular value decomposition and its own definition."""

import numpy as np
import pytest
import torch

from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.pca import network as pca
from tetgan.methods.pca.network import PcaGenerator
from tetgan.methods.pca.options import PcaOptions

HIERARCHY = build_hierarchy(1, 0)
FIELDS = np.random.default_rng(0).normal(0, 0.2, (9, len(HIERARCHY.finest.tets), 4)).astype(np.float32)


def fit(components: int, fields: np.ndarray = FIELDS) -> PcaGenerator:
    model = PcaGenerator(PcaOptions(kind="pca", grid="smoke", components=components), HIERARCHY)
    model.fit(lambda part: fields[:, part])
    return model


def decoded_fields(model: PcaGenerator, latent: torch.Tensor) -> np.ndarray:
    decoded = model.decode(latent).numpy()
    decoded[..., 0] += 0.5  # logits are occupancy less one half
    return decoded


def test_reconstructs_like_a_singular_value_decomposition():
    rows = FIELDS.reshape(len(FIELDS), -1)
    centred = rows - rows.mean(axis=0)
    _, _, directions = np.linalg.svd(centred, full_matrices=False)
    expected = centred @ directions[:4].T @ directions[:4] + rows.mean(axis=0)
    model = fit(4)
    got = decoded_fields(model, model.encode(torch.from_numpy(FIELDS)))
    np.testing.assert_allclose(got.reshape(rows.shape), expected.clip(-1, 1), atol=1e-5)


def test_slices_of_the_data_make_no_difference(monkeypatch):
    whole = fit(4).components
    monkeypatch.setattr(pca, "CHUNK", 5)
    torch.testing.assert_close(fit(4).components, whole, rtol=0, atol=1e-6)


def test_training_codes_have_mean_0_and_variance_1():
    codes = fit(5).encode(torch.from_numpy(FIELDS))
    torch.testing.assert_close(codes.mean(dim=0), torch.zeros(5), rtol=0, atol=1e-5)
    torch.testing.assert_close(codes.var(dim=0), torch.ones(5), rtol=1e-4, atol=0)


def test_all_components_give_the_fields_back():
    model = fit(8)
    got = decoded_fields(model, model.encode(torch.from_numpy(FIELDS)))
    np.testing.assert_allclose(got, FIELDS, atol=1e-5)


@pytest.mark.parametrize("shapes", [1, 3])
def test_more_components_than_shapes_are_left_empty(shapes, caplog):
    model = fit(6, FIELDS[:shapes])
    assert "components" in caplog.text
    got = decoded_fields(model, model.encode(torch.from_numpy(FIELDS[:shapes])))
    np.testing.assert_allclose(got, FIELDS[:shapes], atol=1e-5)
    assert torch.isfinite(model.decode(torch.randn(2, *model.latent_shape))).all()


def test_draws_have_the_mean_and_covariance_of_the_training_fields():
    """A Gaussian latent: N(0, I) in whitened coordinates is the normal distribution of the fields."""
    model = fit(8)
    latent = torch.randn(50_000, *model.latent_shape, generator=torch.Generator().manual_seed(0))
    draws = (model.mean + torch.tensordot(latent * model.deviations, model.components, dims=1)).flatten(1)
    rows = torch.from_numpy(FIELDS).flatten(1)
    # Standard errors: of a mean 0.2 / √50,000 = 0.001, of a covariance √2 · 0.04 / √50,000 = 0.00025.
    torch.testing.assert_close(draws.mean(dim=0), rows.mean(dim=0), rtol=0, atol=0.006)
    torch.testing.assert_close(draws.T.cov(), rows.T.cov(), rtol=0, atol=0.0025)
