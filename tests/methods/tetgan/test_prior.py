"""The fitted prior has the moments it was fitted to."""

import torch

from tetgan.methods.tetgan.prior import FittedPrior


def draw(*shape):
    return torch.randn(*shape, generator=torch.Generator().manual_seed(1))


def test_before_fitting_it_is_standard_normal():
    sample = FittedPrior((3, 2)).sample(4000, torch.Generator().manual_seed(0)).flatten(1)
    # 4,000 draws know a covariance to about 1 / √4000 = 0.016.
    torch.testing.assert_close(sample.T.cov(), torch.eye(6), rtol=0, atol=0.08)


def test_draws_have_the_mean_and_covariance_of_the_codes():
    mixing = draw(6, 6)
    means, variances = draw(50, 6) @ mixing + 2, torch.full((50, 6), 0.25)
    prior = FittedPrior((3, 2))
    prior.fit(means.view(50, 3, 2), variances.view(50, 3, 2))
    sample = prior.sample(20000, torch.Generator().manual_seed(0)).flatten(1)
    expected = means.T.cov() + 0.25 * torch.eye(6)
    scale = expected.diagonal().max()
    torch.testing.assert_close(sample.mean(dim=0), means.mean(dim=0), rtol=0, atol=0.03 * scale**0.5)
    torch.testing.assert_close(sample.T.cov(), expected, rtol=0, atol=0.05 * scale)
