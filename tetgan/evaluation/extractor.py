"""Stage: the feature extractor, trained and put to the test."""

import logging
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from jaxtyping import Float

from tetgan.evaluation.fid import fid, kid
from tetgan.evaluation.options import ExtractorOptions
from tetgan.evaluation.seeds import named_rng
from tetgan.extractor.features import cloud_features
from tetgan.extractor.network import PointNet2, load_classifier
from tetgan.extractor.training import train_classifier
from tetgan.files import whole_file
from tetgan.shapes.clouds import read_clouds

_log = logging.getLogger(__name__)

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
    train_classifier(clouds, categories, options, out_folder)
    found = [read_clouds(path) for path in clouds]
    reference = _pool([each.holdout for each in found], options.noise_samples)
    others = _pool([each.train for each in found], options.noise_samples)
    size = min(len(reference), len(others))
    curve = noise_curve(load_classifier(out_folder).network, reference[:size], others[:size], options.seed)
    with whole_file(out_folder / "noise.csv") as partial:
        curve.to_csv(partial, index=False)
    if not curve["fid"].is_monotonic_increasing:
        _log.warning(
            "the extractor's FID does not rise with noise: do not trust it (%s/noise.csv)", out_folder
        )


def noise_curve(
    network: PointNet2,
    reference: Float[np.ndarray, "N P 3"],
    clouds: Float[np.ndarray, "M P 3"],
    seed: int,
    levels: Sequence[float] = NOISE_LEVELS,
) -> pd.DataFrame:
    """Distance of noisy clouds from clean ones of the same kind, one row per level: noise, fid, kid.

    An extractor can be trusted only if the distances rise. The noise is the same at every level, scaled.
    """
    rng = named_rng(seed, "noise")
    noise = rng.standard_normal(clouds.shape, dtype=np.float32)
    clean = cloud_features(reference, network, "reference features")
    rows = []
    for level in levels:
        noisy = cloud_features(clouds + np.float32(level) * noise, network, f"features at noise {level}")
        distance = kid(clean, noisy, block=len(clean), blocks=1, rng=rng)
        rows.append({"noise": level, "fid": fid(clean, noisy), "kid": distance.value})
    return pd.DataFrame(rows)


def _pool(arrays: Sequence[Float[np.ndarray, "_ P 3"]], samples: int) -> Float[np.ndarray, "N P 3"]:
    """`samples` clouds, an equal share of every category, the categories taking turns."""
    share = min(max(samples // len(arrays), 2), *map(len, arrays))
    return np.stack([array[:share] for array in arrays], axis=1).reshape(-1, *arrays[0].shape[1:])
