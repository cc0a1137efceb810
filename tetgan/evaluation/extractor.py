"""Stage: the feature extractor, trained and put to the test."""

import logging
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from jaxtyping import Float

from tetgan.evaluation.features import cloud_features
from tetgan.evaluation.frechet import fid, kid
from tetgan.evaluation.options import ExtractorOptions
from tetgan.evaluation.seeds import named_rng
from tetgan.files import whole_folder
from tetgan.models.pointnet2 import PointNet2, load_classifier
from tetgan.shapes.clouds import read_clouds
from tetgan.training.classifier import train_classifier

log = logging.getLogger(__name__)

NOISE_LEVELS = (0.0, 0.01, 0.02, 0.04, 0.08)
"""Standard deviations of the noise, in sides of the unit cube."""


def train_extractor(
    clouds: Sequence[Path], categories: Sequence[str], options: ExtractorOptions, out_folder: Path
) -> None:
    """Train the classifier and write beside it how its distances rise as real clouds grow noisy.

    Args:
        clouds, categories, options, out_folder: as `train_classifier`; the folder also receives `noise.csv`.

    Raises:
        UserError: as `train_classifier`.
    """
    with whole_folder(out_folder) as folder:
        train_classifier(clouds, categories, options, folder)
        reference, others = (_pool(clouds, split, options) for split in ("holdout", "train"))
        size = min(len(reference), len(others))
        curve = noise_curve(load_classifier(folder).network, reference[:size], others[:size], options.seed)
        curve.to_csv(folder / "noise.csv", index=False)
    if not curve["fid"].is_monotonic_increasing:
        log.warning(
            "the extractor's FID does not rise with noise: do not trust it (%s/noise.csv)", out_folder
        )


def noise_curve(
    network: PointNet2,
    reference: Float[np.ndarray, "N P 3"],
    clouds: Float[np.ndarray, "M P 3"],
    seed: int,
    levels: Sequence[float] = NOISE_LEVELS,
) -> pd.DataFrame:
    """Distance of noisy clouds from clean ones of the same kind, a row a level: noise, fid, kid.

    An extractor can be trusted only if the distances rise. The noise is the same at every level, scaled.
    """
    rng = named_rng(seed, "noise")
    noise = rng.standard_normal(clouds.shape, dtype=np.float32)
    clean = cloud_features(reference, network, "reference features")
    rows = []
    for level in levels:
        noisy = cloud_features(clouds + np.float32(level) * noise, network, f"features at noise {level}")
        distance = kid(clean, noisy, block=2, blocks=1, rng=rng)
        rows.append({"noise": level, "fid": fid(clean, noisy), "kid": distance.value})
    return pd.DataFrame(rows)


def _pool(clouds: Sequence[Path], split: str, options: ExtractorOptions) -> Float[np.ndarray, "N P 3"]:
    """The same number of clouds of every category, one category after the other in turn."""
    arrays = [read_clouds(path)[split] for path in clouds]
    share = min(max(options.noise_samples // len(arrays), 2), *map(len, arrays))
    return np.stack([array[:share] for array in arrays], axis=1).reshape(-1, *arrays[0].shape[1:])
