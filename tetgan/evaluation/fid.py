"""Distances between two sets of features: Fréchet (FID), its limit for many samples, kernel (KID)."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from tetgan.evaluation.intervals import Interval, recentered_interval, resample_counts, resample_indices


def fid(first: Float[np.ndarray, "N F"], second: Float[np.ndarray, "M F"]) -> float:
    """Squared 2-Wasserstein distance between the Gaussians fitted to two sets of features.

    Heusel et al. (2017), eq. 6: |mu_a - mu_b|^2 + Tr(C_a + C_b - 2 (C_a C_b)^1/2). With C_a = A'A and
    C_b = B'B the last trace is the nuclear norm of AB': no root of a product that rounding makes unsymmetric,
    no square that loses half the digits, and covariances may be singular (fewer samples than features).

    Raises:
        ValueError: a set has fewer than two samples.
    """
    root_first, root_second = _covariance_root(first), _covariance_root(second)
    shift = first.mean(0) - second.mean(0)
    cross = np.linalg.svd(root_first @ root_second.T, compute_uv=False).sum()
    spread = (root_first**2).sum() + (root_second**2).sum() - 2 * cross
    # Rounding can push the spread of equal covariances just below zero.
    return float(shift @ shift + max(spread, 0.0))


def fid_interval(
    first: Float[np.ndarray, "N F"],
    second: Float[np.ndarray, "M F"],
    resamples: int,
    level: float,
    rng: np.random.Generator,
) -> Interval:
    """Bootstrap of `fid` over both sets, moved onto its value because resampled covariances are biased."""
    rows_first = resample_indices(len(first), resamples, rng)
    rows_second = resample_indices(len(second), resamples, rng)
    values = np.array([fid(first[a], second[b]) for a, b in zip(rows_first, rows_second, strict=True)])
    return recentered_interval(fid(first, second), values, level)


class KernelDistance(NamedTuple):
    """Distance of all samples, and its standard deviation over random blocks of them."""

    value: float
    std: float


def kid(
    first: Float[np.ndarray, "N F"],
    second: Float[np.ndarray, "M F"],
    block: int,
    blocks: int,
    rng: np.random.Generator,
) -> KernelDistance:
    """Squared maximum mean discrepancy under the kernel (x'y / F + 1)^3, unbiased.

    Bińkowski et al. (2018), section 4: zero on average when both sets come from one distribution, whatever
    their size, so it can be negative. They publish the mean over random blocks, which tends to the value of
    all samples given here, and the deviation over blocks. A block takes at most all of a set; where it
    takes all of both, blocks do not differ and the deviation is missing.

    Raises:
        ValueError: a set has fewer than two samples.
    """
    kernels = _kernels(first, second)
    whole = kernels.discrepancies(np.ones((1, len(first))), np.ones((1, len(second))))
    values = kernels.discrepancies(
        _block_counts(len(first), block, blocks, rng), _block_counts(len(second), block, blocks, rng)
    )
    told_apart = blocks > 1 and block < max(len(first), len(second))
    return KernelDistance(float(whole[0]), float(values.std(ddof=1)) if told_apart else float("nan"))


def kid_interval(
    first: Float[np.ndarray, "N F"],
    second: Float[np.ndarray, "M F"],
    resamples: int,
    level: float,
    rng: np.random.Generator,
) -> Interval:
    """Bootstrap of the kernel distance over both sets; a sample is never compared with its own copy."""
    kernels = _kernels(first, second)
    whole = kernels.discrepancies(np.ones((1, len(first))), np.ones((1, len(second))))
    values = kernels.discrepancies(
        resample_counts(len(first), resamples, rng), resample_counts(len(second), resamples, rng)
    )
    return recentered_interval(float(whole[0]), values, level)


class _Kernels(NamedTuple):
    """Kernel within each set, its diagonal zero, and between them."""

    first: Float[np.ndarray, "N N"]
    second: Float[np.ndarray, "M M"]
    between: Float[np.ndarray, "N M"]

    def discrepancies(
        self, counts_first: Float[np.ndarray, "R N"], counts_second: Float[np.ndarray, "R M"]
    ) -> Float[np.ndarray, "R"]:
        """Unbiased discrepancy for each row of how often every sample is taken."""
        between = ((counts_first @ self.between) * counts_second).sum(1)
        between /= counts_first.sum(1) * counts_second.sum(1)
        return _mean_within(self.first, counts_first) + _mean_within(self.second, counts_second) - 2 * between


def _kernels(first: Float[np.ndarray, "N F"], second: Float[np.ndarray, "M F"]) -> _Kernels:
    _require_two(first, second)
    within_first, within_second = _kernel(first, first), _kernel(second, second)
    np.fill_diagonal(within_first, 0)
    np.fill_diagonal(within_second, 0)
    return _Kernels(within_first, within_second, _kernel(first, second))


def _kernel(first: Float[np.ndarray, "N F"], second: Float[np.ndarray, "M F"]) -> Float[np.ndarray, "N M"]:
    return (first.astype(np.float64) @ second.T / first.shape[1] + 1) ** 3


def _mean_within(
    kernel: Float[np.ndarray, "N N"], counts: Float[np.ndarray, "R N"]
) -> Float[np.ndarray, "R"]:
    """Mean of the kernel over ordered pairs of different samples."""
    pairs = counts.sum(1) ** 2 - (counts**2).sum(1)
    # A resample of very few may hold one sample alone, which has no pairs and no say.
    return ((counts @ kernel) * counts).sum(1) / np.maximum(pairs, 1)


def _block_counts(size: int, block: int, blocks: int, rng: np.random.Generator) -> Float[np.ndarray, "R N"]:
    taken = np.tile(np.arange(size) < block, (blocks, 1))
    return rng.permuted(taken, axis=1).astype(np.float64)


def _covariance_root(features: Float[np.ndarray, "N F"]) -> Float[np.ndarray, "K F"]:
    """R with R'R the unbiased covariance; never more rows than features."""
    _require_two(features)
    centered = features.astype(np.float64) - features.mean(0, dtype=np.float64)
    centered /= np.sqrt(len(features) - 1)
    return centered if len(features) <= features.shape[1] else np.asarray(np.linalg.qr(centered, mode="r"))


def _require_two(*sets: Float[np.ndarray, "_ _"]) -> None:
    for features in sets:
        if len(features) < 2:
            raise ValueError(f"a distance between sets needs two samples each, not {len(features)}")


_PARTS = 4

FEWEST = 4
"""Samples of each set: two sizes, and no part of one sample."""


def fid_infinity(
    found: Float[np.ndarray, "N F"], real: Float[np.ndarray, "N F"], rng: np.random.Generator
) -> float:
    """FID extrapolated to infinitely many samples; it can be negative.

    Chong and Forsyth (2020), section 4: the bias of FID is nearly proportional to 1/N, so the line through
    FIDs at several N meets 1/N = 0 near the unbiased value. They vary the number of generated samples alone,
    against many real ones. Here both sides are few and both biased, so both are cut at random into 1, 2, 3
    and 4 disjoint parts of equal size and the FIDs of equal parts averaged: every size uses everything, and
    the sizes are evenly spaced in 1/N. The bias bends where N is less than the number of directions in which
    the features vary, so the line still falls short there; it is no cure for very few samples.

    Raises:
        ValueError: the sets differ in size, or have fewer than four samples.
    """
    if len(found) != len(real) or len(found) < FEWEST:
        raise ValueError(f"needs two sets of one size, at least {FEWEST}, not {len(found)} and {len(real)}")
    found, real = found[rng.permutation(len(found))], real[rng.permutation(len(real))]
    counts = range(1, min(_PARTS, len(found) // 2) + 1)
    sizes = [len(found) // parts for parts in counts]
    means = [
        np.mean([fid(found[i * n : (i + 1) * n], real[i * n : (i + 1) * n]) for i in range(parts)])
        for parts, n in zip(counts, sizes, strict=True)
    ]
    _, intercept = np.polyfit(1 / np.array(sizes), means, 1)
    return float(intercept)


def fid_infinity_interval(
    found: Float[np.ndarray, "N F"],
    real: Float[np.ndarray, "N F"],
    *,
    value: float,
    resamples: int,
    level: float,
    rng: np.random.Generator,
) -> Interval:
    """Bootstrap of `fid_infinity` over both sets, moved onto its `value`."""
    rows = zip(
        resample_indices(len(found), resamples, rng), resample_indices(len(real), resamples, rng), strict=True
    )
    values = np.array([fid_infinity(found[a], real[b], rng) for a, b in rows])
    return recentered_interval(value, values, level)
