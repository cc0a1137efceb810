"""The extractor's files, and the order of its distances under noise."""

import json

import numpy as np
import pandas as pd

from tetgan.evaluation.extractor import NOISE_LEVELS, noise_curve
from tetgan.extractor.features import cloud_features
from tetgan.extractor.network import load_classifier
from tetgan.shapes.clouds import read_clouds


def test_the_folder_holds_weights_options_log_and_noise(extractor):
    assert {path.name for path in extractor.iterdir()} == {
        "weights.safetensors",
        "options.json",
        "log.csv",
        "noise.csv",
        "events",
        "checkpoint.pt",
    }
    assert json.loads((extractor / "options.json").read_text())["categories"] == ["slab", "rod"]


def test_fid_and_kid_rise_as_real_clouds_grow_noisy(extractor):
    curve = pd.read_csv(extractor / "noise.csv")
    assert curve["noise"].tolist() == list(NOISE_LEVELS)
    assert curve["fid"].is_monotonic_increasing
    assert curve["fid"].iloc[-1] > 2 * curve["fid"].iloc[0]


def test_noise_curve_repeats(extractor, clouds):
    network = load_classifier(extractor).network
    found = read_clouds(clouds[0])
    first, second = (
        noise_curve(network, found.holdout[:2], found.train[:2], 3, levels=(0.0, 0.1)) for _ in range(2)
    )
    pd.testing.assert_frame_equal(first, second)


def test_features_do_not_depend_on_place_size_or_company(extractor, clouds):
    # Clouds are centred and scaled to the unit sphere; the batch plays no part in evaluation mode.
    network = load_classifier(extractor).network
    train = read_clouds(clouds[1]).train[:3]
    together = cloud_features(train, network)
    assert together.shape == (3, 256)
    alone = cloud_features(np.float32(4) * train[2:3] + np.float32(2), network)
    # float32 coordinates moved by 2 keep six digits; batch norms and three levels lose two more
    np.testing.assert_allclose(alone, together[2:3], atol=2e-2)
