"""Training of TetGAN: it learns, runs repeat, and a killed run ends with the same weights."""

import csv
import json
import logging
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import torch

from tetgan.errors import UserError
from tetgan.fields.field import surface_tets
from tetgan.fields.store import FieldStore
from tetgan.methods.tetgan import training as trainer_module
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.methods.tetgan.training import TetganRun
from tetgan.models.files import load_generator
from tetgan.models.iou import occupancy_iou
from tetgan.training.run import train_model

SMALL = TetganOptions.parse(
    {"grid": "smoke", "width": 4, "code": 8, "local_critic_width": 1, "global_critic_width": 2}
)
BRIEF = {"epochs": 4, "batch_size": 12, "picture_every": 1000, "ema": 0.9, "device": "cpu"}
WITH_CRITICS = {"adversarial_start": 0.25, "adversarial_every": 2}


def brief(**changes) -> TetganTraining:
    return TetganTraining.parse(BRIEF | changes)


@pytest.fixture(autouse=True)
def no_pictures(monkeypatch):
    """Drawing is tested on its own and takes longer than the rest."""
    monkeypatch.setattr(trainer_module, "draw_decoded", lambda *_: None)


def weights(folder: Path) -> bytes:
    return (folder / "weights.safetensors").read_bytes()


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "log.csv").open() as stream:
        return list(csv.DictReader(stream))


def test_overfits_eight_shapes(index):
    options = TetganOptions.parse({"grid": "smoke", "width": 12, "code": 64})
    run = TetganRun(options, brief(learning_rate=3e-3, betas=[0.9, 0.99]), FieldStore.open(index), 0)
    field = run.data.batch(torch.arange(8))
    for step in range(1, 401):
        run.learner.autoencoder_step(field, 0.0, torch.Generator().manual_seed(step))
        if step % 25 == 0 and (iou := reconstruction_iou(run, field)) >= 0.95:
            return
    pytest.fail(f"IoU {iou:.3f} after 400 steps")


def reconstruction_iou(run: TetganRun, field: torch.Tensor) -> float:
    with torch.no_grad():
        decoded = run.generator.decode(run.generator.encode(field))
    return float(occupancy_iou(decoded[..., 0].numpy() > 0, field[..., 0].numpy() > 0.5).mean())


def test_beats_the_mean_shape_on_validation(index, tmp_path):
    store = FieldStore.open(index)
    training = brief(epochs=30, learning_rate=2e-3, betas=[0.9, 0.99], adversarial_start=1, ema=None)
    train_model(index, SMALL, training, 0, tmp_path)
    train, held_out = (store.stack(store.ids(split)).occupancy for split in ("train", "validation"))
    mean_shape = np.broadcast_to(train.mean(axis=0) > 0.5, held_out.shape)
    assert float(rows(tmp_path)[-1]["validation_iou"]) > occupancy_iou(mean_shape, held_out).mean()


@pytest.fixture(scope="module")
def in_one_go(tiny_index, tmp_path_factory) -> Path:
    """Four epochs of seed 0, critics from the second on, never interrupted."""
    folder = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(trainer_module, "draw_decoded", lambda *_: None)
        train_model(tiny_index, SMALL, brief(**WITH_CRITICS), 0, folder)
    return folder


def test_another_seed_starts_elsewhere(tiny_index):
    store = FieldStore.open(tiny_index)
    first, second = (TetganRun(SMALL, brief(), store, seed).generator for seed in (0, 1))
    assert not torch.equal(first.head.mean.weight, second.head.mean.weight)


def test_mu_is_in_the_networks_unit(tiny_index):
    store = FieldStore.open(tiny_index)
    options = SMALL.model_copy(update={"displacement_range": 0.5})
    objectives = TetganRun(options, brief(), store, 0).learner.objectives
    surface = [
        field.displacement[surface_tets(field.occupancy, store.hierarchy.finest.neighbors)]
        for field in map(store.read, store.ids("train"))
    ]
    mu = np.mean([np.linalg.norm(displacement, axis=1).mean() for displacement in surface])
    assert objectives.mu == pytest.approx(mu / (0.5 * store.max_displacement), rel=1e-5)


def test_the_same_seed_gives_the_same_bytes(tiny_index, in_one_go, tmp_path):
    train_model(tiny_index, SMALL, brief(**WITH_CRITICS), 0, tmp_path / "same")
    assert weights(tmp_path / "same") == weights(in_one_go)


class Killed(BaseException):
    """A stand-in for a kill: the loop has no chance to tidy up after it."""


@pytest.mark.parametrize("step", [4, 5])
def test_a_run_that_was_stopped_ends_like_one_that_was_not(
    tiny_index, in_one_go, tmp_path, monkeypatch, step
):
    # Two steps an epoch: 4 is between two epochs, 5 inside one.
    options = brief(**WITH_CRITICS, checkpoint_seconds=0)
    take_step = TetganRun.take_step

    def stop(self, rows, at, *others):
        if at == step:
            raise Killed
        return take_step(self, rows, at, *others)

    with monkeypatch.context() as patch, pytest.raises(Killed):
        patch.setattr(TetganRun, "take_step", stop)
        train_model(tiny_index, SMALL, options, 0, tmp_path)
    assert not (tmp_path / "weights.safetensors").exists()
    train_model(tiny_index, SMALL, options, 0, tmp_path)
    assert weights(tmp_path) == weights(in_one_go)
    assert [without_time(row) for row in rows(tmp_path)] == [without_time(row) for row in rows(in_one_go)]


def test_a_run_killed_by_the_system_ends_like_one_that_was_not(tiny_index, tmp_path):
    """SIGKILL at whatever step, read or write the process happens to be in; then the same command again."""
    training = BRIEF | {"epochs": 40, "checkpoint_seconds": 0, "adversarial_start": 1}
    commands = {
        name: [
            *(sys.executable, "-c", "from tetgan.cli import main; main()"),
            *("train", str(tiny_index), str(tmp_path / name)),
            *("--model", SMALL.model_dump_json(), "--training", json.dumps(training), "--threads", "1"),
        ]
        for name in ("whole", "killed")
    }
    killed = subprocess.Popen(commands["killed"], stderr=subprocess.DEVNULL)
    until = time.monotonic() + 60
    while not (tmp_path / "killed" / "checkpoint.pt").is_file() and time.monotonic() < until:
        time.sleep(0.01)
    killed.kill()
    assert killed.wait() == -signal.SIGKILL, "the run ended before it was killed"
    resumed, _ = (
        subprocess.run(command, check=True, capture_output=True, text=True)
        for command in reversed(commands.values())
    )
    assert "resumed at step" in resumed.stderr
    assert weights(tmp_path / "killed") == weights(tmp_path / "whole")


def without_time(row: dict[str, str]) -> dict[str, str]:
    return {name: value for name, value in row.items() if name != "seconds"}


def test_a_run_with_a_head_start_resumes_as_well(tiny_index, tmp_path, monkeypatch):
    model = SMALL.model_copy(update={"prior": "fitted"})
    options = brief(adversarial_start=0.75, head_start=0.5, checkpoint_seconds=0)
    train_model(tiny_index, model, options, 0, tmp_path / "whole")
    assert [row["validation_iou"] != "" for row in rows(tmp_path / "whole")] == [False, False, False, True]
    start_head, stops = TetganLearner.start_head, [Killed]

    def stop_once(self, batches):
        if stops:
            raise stops.pop()
        start_head(self, batches)

    monkeypatch.setattr(TetganLearner, "start_head", stop_once)
    with pytest.raises(Killed):
        train_model(tiny_index, model, options, 0, tmp_path / "stopped")
    train_model(tiny_index, model, options, 0, tmp_path / "stopped")
    assert weights(tmp_path / "stopped") == weights(tmp_path / "whole")


def test_a_finished_checkpoint_is_not_resumed(tiny_index, in_one_go, tmp_path, caplog):
    shutil.copytree(in_one_go, tmp_path / "again")
    caplog.set_level(logging.INFO)
    train_model(tiny_index, SMALL, brief(**WITH_CRITICS), 0, tmp_path / "again")
    assert "finished; training starts afresh" in caplog.text
    assert weights(tmp_path / "again") == weights(in_one_go)


def test_a_checkpoint_of_another_run_is_named_and_left(tiny_index, in_one_go, tmp_path, caplog):
    shutil.copytree(in_one_go, tmp_path / "again")
    train_model(tiny_index, SMALL, brief(epochs=1, adversarial_start=1), 0, tmp_path / "again")
    assert "other options; training starts afresh" in caplog.text
    assert len(rows(tmp_path / "again")) == 1


def test_a_damaged_checkpoint_is_named_and_left(tiny_index, tmp_path, caplog):
    (tmp_path / "checkpoint.pt").write_bytes(b"half a file")
    train_model(tiny_index, SMALL, brief(epochs=1, adversarial_start=1), 0, tmp_path)
    assert "cannot be read" in caplog.text
    assert (tmp_path / "weights.safetensors").exists()


def test_the_log_and_the_options_tell_the_run(tiny_index, in_one_go):
    table = rows(in_one_go)
    assert [row["epoch"] for row in table] == ["1", "2", "3", "4"]
    assert table[0]["local_gap"] == ""  # before the critics begin
    assert all(float(table[-1][name]) for name in ("seconds", "kl", "global_gap", "local_penalty"))
    assert 0 <= float(table[-1]["validation_iou"]) <= 1
    record = json.loads((in_one_go / "options.json").read_text())
    assert record["model"]["width"] == SMALL.width
    assert record["training"]["epochs"] == 4
    assert load_generator(in_one_go, FieldStore.open(tiny_index).hierarchy).latent_shape == (8,)


def test_divergence_at_once_is_an_error_a_person_can_read(tiny_index, tmp_path):
    with pytest.raises(UserError, match="diverged in its first epoch; lower learning_rate"):
        train_model(tiny_index, SMALL, brief(learning_rate=1e30, adversarial_start=1), 0, tmp_path)


def test_after_a_later_divergence_the_averages_of_the_epoch_before_are_kept(
    tiny_index, tmp_path, monkeypatch
):
    model = SMALL.model_copy(update={"prior": "fitted"})
    training = brief(adversarial_start=1)
    take_step, kept = TetganRun.take_step, {}

    def poison(self, rows, step, *others):
        if step == 4:  # the first of the third epoch
            with self.averaged():
                kept.update({name: value.clone() for name, value in self.generator.state_dict().items()})
            with torch.no_grad():
                next(self.generator.parameters()).fill_(torch.nan)
        return take_step(self, rows, step, *others)

    monkeypatch.setattr(TetganRun, "take_step", poison)
    train_model(tiny_index, model, training, 0, tmp_path)
    assert json.loads((tmp_path / "options.json").read_text())["diverged_in_epoch"] == 3
    loaded = load_generator(tmp_path, FieldStore.open(tiny_index).hierarchy).state_dict()
    for name, value in kept.items():
        assert torch.equal(loaded[name], value) != name.startswith("prior"), (
            name
        )  # which is fitted at the end
