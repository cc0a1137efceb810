"""The fitted prior has the moments it was fitted to."""

import torch

from tetgan.methods.tetgan.prior import FittedPrior


def draw(*shape):
    return torch.randn(*shape, generator=torch.Generator().manual_seed(1))


def test_before_fitting_it_is_standard_normal():
    sample = FittedPrior((3, 2)).sample(4000, torch.Generator().manual_seed(0)).flatten(1)
    # 4,000 draws know a covariance to about 1 / √4000 = 0.016.
    torch.testing.assert_close(sample.T.cov(), torch.eye(6), rtol=0, atol=0.08)
    torch.testing.assert_close(sample.mean(dim=0), torch.zeros(6), rtol=0, atol=0.08)


def test_two_codes_span_one_direction():
    # Means (0, 0) and (2, 4): the mean is (1, 2), and an unbiased covariance of 2 (1, 2) (1, 2)ᵀ.
    prior = FittedPrior((2,))
    prior.fit(torch.tensor([[0.0, 0.0], [2.0, 4.0]]), torch.tensor([[1.0, 4.0], [3.0, 4.0]]))
    torch.testing.assert_close(prior.mean, torch.tensor([1.0, 2.0]))
    covariance = prior.directions.T @ prior.directions
    torch.testing.assert_close(covariance, torch.tensor([[2.0, 4.0], [4.0, 8.0]]))
    torch.testing.assert_close(prior.noise.square(), torch.tensor([2.0, 4.0]))


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
