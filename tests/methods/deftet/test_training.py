"""Training of the surface network: it learns, repeats, resumes, and needs a TetGAN."""

import csv
from pathlib import Path

import pytest
import torch

from tetgan.errors import UserError
from tetgan.fields.store import FieldStore
from tetgan.methods.deftet.network import DeftetGenerator
from tetgan.methods.deftet.options import DeftetOptions, DeftetTraining
from tetgan.methods.deftet.training import DeftetLearner
from tetgan.methods.pca.options import PcaOptions
from tetgan.methods.tetgan.options import TetganOptions
from tetgan.models.files import build_generator, load_generator, save_generator
from tetgan.training.run import train_model

TETGAN = TetganOptions(grid="smoke", width=4, code=8)
OPTIONS = DeftetOptions(kind="deftet", grid="smoke", of="full", width=16, blocks=2)


def brief(**changes) -> DeftetTraining:
    values = {"epochs": 6, "batch_size": 12, "learning_rate": 5e-3, "betas": [0.9, 0.99], "device": "cpu"}
    return DeftetTraining.parse(values | changes)


@pytest.fixture(scope="module")
def full(index, tmp_path_factory) -> Path:
    """An untrained TetGAN, as if trained."""
    folder, store = tmp_path_factory.mktemp("full"), FieldStore.open(index)
    torch.manual_seed(0)
    save_generator(folder, build_generator(TETGAN, store.hierarchy), TETGAN, store.hierarchy)
    return folder


def weights(folder: Path) -> bytes:
    return (folder / "weights.safetensors").read_bytes()


def last_row(folder: Path) -> dict[str, str]:
    with (folder / "log.csv").open() as stream:
        return list(csv.DictReader(stream))[-1]


def test_it_learns_to_move_held_out_boundaries(index, full, tmp_path):
    training = brief(epochs=30, decay="cosine")
    train_model(index, OPTIONS, training, 0, tmp_path, of=full)
    store = FieldStore.open(index)
    learner = DeftetLearner(OPTIONS, training, store, 0, of=load_generator(full, store.hierarchy))
    unmoved = torch.cat([target for _, target in learner.held_out]).square().mean()
    assert float(last_row(tmp_path)["validation_displacement_loss"]) < 0.7 * float(unmoved)


def test_the_other_model_is_saved_as_it_was(index, full, tmp_path):
    store = FieldStore.open(index)
    train_model(index, OPTIONS, brief(epochs=1), 0, tmp_path, of=full)
    trained, before = load_generator(tmp_path, store.hierarchy), load_generator(full, store.hierarchy)
    assert isinstance(trained, DeftetGenerator)
    assert trained.unit == pytest.approx(store.mu)
    for name, value in before.state_dict().items():
        assert torch.equal(trained.of.state_dict()[name], value)


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(index, full, tmp_path):
    for name, seed in (("one", 0), ("same", 0), ("other", 1)):
        train_model(index, OPTIONS, brief(epochs=2, ema=0.9), seed, tmp_path / name, of=full)
    assert weights(tmp_path / "one") == weights(tmp_path / "same")
    assert weights(tmp_path / "one") != weights(tmp_path / "other")


class Killed(BaseException):
    """A stand-in for a kill: the loop has no chance to tidy up after it."""


def test_a_run_that_was_stopped_ends_like_one_that_was_not(index, full, tmp_path, monkeypatch):
    training = brief(ema=0.9, decay="cosine", checkpoint_seconds=0)
    train_model(index, OPTIONS, training, 0, tmp_path / "whole", of=full)
    take_step = DeftetLearner.take_step

    def stop(self, rows, step, *others):
        if step == 7:
            raise Killed
        return take_step(self, rows, step, *others)

    with monkeypatch.context() as patch, pytest.raises(Killed):
        patch.setattr(DeftetLearner, "take_step", stop)
        train_model(index, OPTIONS, training, 0, tmp_path / "stopped", of=full)
    train_model(index, OPTIONS, training, 0, tmp_path / "stopped", of=full)
    assert weights(tmp_path / "stopped") == weights(tmp_path / "whole")


def test_it_needs_a_tetgan(index, full, tmp_path):
    with pytest.raises(UserError, match="--of: 'deftet' needs the folder"):
        train_model(index, OPTIONS, brief(), 0, tmp_path)
    with pytest.raises(UserError, match="not a trained model"):
        train_model(index, OPTIONS, brief(), 0, tmp_path, of=tmp_path / "absent")
    store, pca = FieldStore.open(index), PcaOptions(kind="pca", grid="smoke", components=2)
    save_generator(tmp_path / "pca", build_generator(pca, store.hierarchy), pca, store.hierarchy)
    with pytest.raises(UserError, match="a model of kind 'pca'; 'deftet' is built on tetgan"):
        train_model(index, OPTIONS, brief(), 0, tmp_path, of=tmp_path / "pca")


def test_a_checkpoint_on_other_weights_is_not_resumed(index, full, tmp_path, caplog, monkeypatch):
    training, store = brief(epochs=2, checkpoint_seconds=0), FieldStore.open(index)
    other = load_generator(full, store.hierarchy)
    with torch.no_grad():
        next(other.parameters()).add_(1)
    save_generator(tmp_path / "other", other, TETGAN, store.hierarchy)
    take_step = DeftetLearner.take_step

    def stop(self, rows, step, *others):
        if step == 1:
            raise Killed
        return take_step(self, rows, step, *others)

    with monkeypatch.context() as patch, pytest.raises(Killed):
        patch.setattr(DeftetLearner, "take_step", stop)
        train_model(index, OPTIONS, training, 0, tmp_path / "stopped", of=full)
    train_model(index, OPTIONS, training, 0, tmp_path / "stopped", of=tmp_path / "other")
    assert "of a run with other model underneath; training starts afresh" in caplog.text
