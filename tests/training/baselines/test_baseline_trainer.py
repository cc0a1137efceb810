"""That runs of the baselines repeat, resume exactly, are saved and loaded, and survive a divergence."""

import csv
import json
from pathlib import Path

import pytest
import torch

from tetgan.errors import UserError
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.models.options import ModelOptions
from tetgan.models.registry import load_generator, load_surface_model
from tetgan.options import parse_options
from tetgan.training.baselines.trainer import BaselineTrainer, build_learner
from tetgan.training.kinds import training_class
from tetgan.training.trainer import train_model

KINDS = ("occnet", "shapegan-gan", "shapegan-vae")
BRIEF = {
    "occnet": {"epochs": 4, "batch_size": 2, "points": 64},
    # Two steps at 8³ and two, both blended in, at 16³, of which one is a generator's.
    "shapegan-gan": {"epochs": [1, 1, 1], "batch_size": 2, "critic_steps": 2, "fade_in": 2},
    "shapegan-vae": {"epochs": 3, "batch_size": 3},
}


def model(kind: str):
    return parse_options(ModelOptions, {"kind": kind}, kind)


def training(kind: str, **changes):
    return training_class(model(kind)).parse({"device": "cpu"} | BRIEF[kind] | changes)


def train(kind: str, indexes: dict[str, Path], folder: Path, seed: int = 0, **changes) -> None:
    train_model(indexes[kind], model(kind), training(kind, **changes), seed, folder)


def weights(folder: Path) -> bytes:
    return (folder / "weights.safetensors").read_bytes()


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "log.csv").open() as stream:
        return [row | {"seconds": ""} for row in csv.DictReader(stream)]


@pytest.fixture(scope="module")
def in_one_go(indexes, tmp_path_factory) -> Path:
    """A folder for each kind, seed 0, never interrupted."""
    folder = tmp_path_factory.mktemp("whole")
    for kind in KINDS:
        train(kind, indexes, folder / kind)
    return folder


class Killed(BaseException):
    """Stands for a kill: the trainer has no chance to tidy up after it."""


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_that_was_stopped_ends_like_one_that_was_not(indexes, in_one_go, tmp_path, monkeypatch, kind):
    take_step = BaselineTrainer.take_step

    def stop(self, draws):
        if self.step == 3:  # within an epoch
            raise Killed
        return take_step(self, draws)

    with monkeypatch.context() as patch, pytest.raises(Killed):
        patch.setattr(BaselineTrainer, "take_step", stop)
        train(kind, indexes, tmp_path, checkpoint_seconds=0)
    assert not (tmp_path / "weights.safetensors").exists()
    train(kind, indexes, tmp_path, checkpoint_seconds=0)
    assert weights(tmp_path) == weights(in_one_go / kind)
    assert rows(tmp_path) == rows(in_one_go / kind)


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_seed_gives_the_same_bytes_and_another_does_not(indexes, in_one_go, tmp_path, kind):
    train(kind, indexes, tmp_path / "same")
    assert weights(tmp_path / "same") == weights(in_one_go / kind)
    train(kind, indexes, tmp_path / "other", seed=1)
    assert weights(tmp_path / "other") != weights(in_one_go / kind)


@pytest.mark.parametrize("kind", KINDS)
def test_a_trained_model_is_loaded_without_a_grid(indexes, in_one_go, kind):
    loaded = load_surface_model(in_one_go / kind)
    assert not loaded.training
    assert loaded.latent_shape == (128,)
    record = json.loads((in_one_go / kind / "options.json").read_text())
    assert record["model"]["kind"] == kind
    assert record["training"]["batch_size"] == BRIEF[kind]["batch_size"]
    assert record["seed"] == 0
    assert record["diverged_in_epoch"] is None


def test_a_model_of_the_wrong_sort_is_named(in_one_go):
    with pytest.raises(UserError, match="occnet, which has no fields"):
        load_generator(in_one_go / "occnet", build_hierarchy(1, 0))


def test_the_log_has_the_columns_of_the_model(in_one_go):
    occnet, gan = rows(in_one_go / "occnet"), rows(in_one_go / "shapegan-gan")
    assert list(occnet[0]) == [
        *("epoch", "seconds", "reconstruction_loss", "kl", "validation_iou", "validation_accuracy")
    ]
    assert [row["validation_iou"] != "" for row in occnet] == [False, False, False, True]  # the last at least
    assert [row["resolution"] for row in gan] == ["8", "16", "32"]
    assert [row["fade"] for row in gan] == ["1", "0.125", "0.125"]  # means of 0 and ¼


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_that_diverges_keeps_the_weights_before_and_says_so(indexes, tmp_path, caplog, kind):
    learner = build_learner(indexes[kind], model(kind), training(kind), 0)
    run = BaselineTrainer(learner, model(kind), training(kind), 0, tmp_path)
    take_step, kept = learner.take_step, {}

    def poisoned(rows, step, epoch, draws):
        losses = take_step(rows, step, epoch, draws)
        if epoch < 1:
            kept.update({name: value.clone() for name, value in learner.generator.state_dict().items()})
        elif epoch < 2:
            with torch.no_grad():
                next(learner.generator.parameters()).fill_(torch.nan)
        return losses

    learner.take_step = poisoned
    run.run()
    assert "diverged in epoch 2" in caplog.text
    assert json.loads((tmp_path / "options.json").read_text())["diverged_in_epoch"] == 2
    assert len(rows(tmp_path)) == 2
    loaded = load_surface_model(tmp_path).state_dict()
    assert all(torch.equal(loaded[name], value) for name, value in kept.items())


def test_an_infinite_loss_is_a_divergence_too(indexes, tmp_path):
    train("occnet", indexes, tmp_path, learning_rate=1e30)
    record = json.loads((tmp_path / "options.json").read_text())
    assert record["diverged_in_epoch"] == 1
    assert all(value.isfinite().all() for value in load_surface_model(tmp_path).state_dict().values())


def test_each_epoch_takes_every_shape_once_in_parts_of_a_size(indexes, tmp_path):
    learner = build_learner(indexes["shapegan-vae"], model("shapegan-vae"), training("shapegan-vae"), 0)
    run = BaselineTrainer(learner, model("shapegan-vae"), training("shapegan-vae"), 0, tmp_path)
    orders = []
    for step in range(4):
        run.step = step
        orders.append(run._rows().tolist())
    assert [len(part) for part in orders] == [2, 2, 2, 2]  # four shapes, three a batch at most
    assert sorted(orders[0] + orders[1]) == sorted(orders[2] + orders[3]) == [0, 1, 2, 3]
