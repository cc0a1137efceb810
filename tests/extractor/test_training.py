"""Training of the PointNet++ classifier on flat and on upright boxes."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import torch

from tetgan.errors import UserError
from tetgan.extractor.options import ExtractorOptions
from tetgan.extractor.training import ClassifierLearner, _train, _turn, read_splits, train_classifier
from tetgan.nn.device import device_name, pick_device

OPTIONS = ExtractorOptions(train=4, holdout=2, epochs=3, batch_size=4, seed=1)


def write_boxes(path: Path, size: tuple[float, float, float], count: int = 6, points: int = 1024) -> Path:
    rng = np.random.default_rng(0)
    drawn = (rng.random((2 * count, points, 3)) * size).astype(np.float32)
    names = np.array([str(i) for i in range(count)])
    np.savez(path, train=drawn[:count], holdout=drawn[count:], train_ids=names, holdout_ids=names)
    return path


@pytest.fixture(scope="module")
def boxes(tmp_path_factory) -> list[Path]:
    folder = tmp_path_factory.mktemp("boxes")
    return [
        write_boxes(folder / "lying.npz", (1, 0.1, 1)),
        write_boxes(folder / "standing.npz", (0.1, 1, 0.1)),
    ]


@pytest.fixture(scope="module")
def trained(boxes, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("trained") / "classifier"
    train_classifier(boxes, ["lying", "standing"], OPTIONS, folder)
    return folder


def digest(folder: Path) -> str:
    return hashlib.sha256((folder / "weights.safetensors").read_bytes()).hexdigest()


def test_log_and_options_tell_what_was_done(trained):
    log = pd.read_csv(trained / "log.csv")
    assert log.columns.tolist() == ["epoch", "seconds", "loss", "train_accuracy", "holdout_accuracy"]
    assert log["epoch"].tolist() == [1, 2, 3]
    about = json.loads((trained / "options.json").read_text())
    assert about["categories"] == ["lying", "standing"]
    assert about["device"] == device_name(pick_device("auto"))
    assert about["holdout_accuracy"] == log["holdout_accuracy"].iloc[-1]
    assert ExtractorOptions.parse(about["options"]) == OPTIONS


def test_training_learns(trained):
    log = pd.read_csv(trained / "log.csv")
    assert log["loss"].iloc[-1] < log["loss"].iloc[0]


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(boxes, tmp_path):
    before = torch.random.get_rng_state()
    for name, seed in (("one", 1), ("again", 1), ("other", 2)):
        options = OPTIONS.model_copy(update={"seed": seed, "epochs": 1})
        train_classifier(boxes, ["lying", "standing"], options, tmp_path / name)
    assert digest(tmp_path / "again") == digest(tmp_path / "one") != digest(tmp_path / "other")
    assert torch.equal(torch.random.get_rng_state(), before)


def test_a_run_that_was_stopped_ends_like_one_that_was_not(boxes, trained, tmp_path):
    splits = read_splits(boxes, OPTIONS, torch.device("cpu"))

    def train(learner: ClassifierLearner) -> None:
        _train(learner, ["lying", "standing"], tmp_path, checkpoint_seconds=0.0)

    stopped = ClassifierLearner(*splits, 2, OPTIONS)
    take_step = stopped.take_step

    def stop(rows, step, *others):
        if step == 3:  # within an epoch
            raise KeyboardInterrupt
        return take_step(rows, step, *others)

    stopped.take_step = stop
    with pytest.raises(KeyboardInterrupt):
        train(stopped)
    assert not (tmp_path / "weights.safetensors").exists()
    train(ClassifierLearner(*splits, 2, OPTIONS))
    assert digest(tmp_path) == digest(trained)
    logs = (pd.read_csv(folder / "log.csv").drop(columns="seconds") for folder in (tmp_path, trained))
    pd.testing.assert_frame_equal(*logs)


def test_a_last_batch_of_one_cloud_is_left_out(boxes):
    learner = ClassifierLearner(*read_splits(boxes, OPTIONS, torch.device("cpu")), 2, OPTIONS)
    learner.batch_size = 3
    assert [len(rows) for rows in learner.batches(torch.arange(7))] == [3, 3]
    assert [len(rows) for rows in learner.batches(torch.arange(8))] == [3, 3, 2]


def test_a_checkpoint_is_taken_as_it_is_and_its_accuracy_measured(boxes, trained, tmp_path):
    options = ExtractorOptions(checkpoint=trained, holdout=2)
    # Another order of the categories: the labels must follow.
    train_classifier(boxes[::-1], ["standing", "lying"], options, tmp_path / "taken")
    assert digest(tmp_path / "taken") == digest(trained)
    accuracies = [
        json.loads((f / "options.json").read_text())["holdout_accuracy"]
        for f in (tmp_path / "taken", trained)
    ]
    assert accuracies[0] == accuracies[1]


def test_a_checkpoint_of_other_categories_is_refused(boxes, trained, tmp_path):
    options = ExtractorOptions(checkpoint=trained)
    with pytest.raises(UserError, match="does not know chair"):
        train_classifier(boxes, ["lying", "chair"], options, tmp_path / "refused")
    assert not (tmp_path / "refused").exists()


def test_one_category_or_too_few_points_are_refused(boxes, tmp_path):
    with pytest.raises(UserError, match="two categories"):
        train_classifier(boxes[:1], ["lying"], OPTIONS, tmp_path / "out")
    thin = write_boxes(tmp_path / "thin.npz", (1, 1, 1), points=1000)
    with pytest.raises(UserError, match="1000 points a cloud"):
        train_classifier([boxes[0], thin], ["lying", "thin"], OPTIONS, tmp_path / "out")


def test_turning_keeps_heights_and_lengths():
    points = torch.rand(3, 50, 3, generator=torch.Generator().manual_seed(0))
    turned = _turn(points, torch.Generator().manual_seed(1))
    assert torch.equal(turned[..., 1], points[..., 1])
    torch.testing.assert_close(turned.norm(dim=2), points.norm(dim=2))
    assert not torch.allclose(turned, points)
