"""Training of both stages: they learn, repeat, and resume where they were stopped."""

import csv
from pathlib import Path

import numpy as np
import pytest
import torch

from tetgan.fields.store import FieldStore
from tetgan.methods.tetflow.options import TetflowOptions, TetflowTraining
from tetgan.methods.tetflow.training import TetflowLearner
from tetgan.models.files import load_generator
from tetgan.models.sampling import generate_fields, reconstruct_fields
from tetgan.training.loop import step_draws
from tetgan.training.run import train_model

SMALL = {
    "width": 8,
    "base_width": 16,
    "blocks": 1,
    "code": 4,
    "flow_width": 16,
    "flow_layers": 1,
    "flow_heads": 2,
}
OPTIONS = TetflowOptions(kind="tetflow", grid="smoke", flow_steps=3, **SMALL)


def brief(**changes) -> TetflowTraining:
    values = {
        "epochs": 2,
        "flow_epochs": 2,
        "batch_size": 8,
        "warmup": 2,
        "device": "cpu",
        "validate_every": 1,
    }
    return TetflowTraining.parse(values | changes)


def weights(folder: Path) -> bytes:
    return (folder / "weights.safetensors").read_bytes()


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "log.csv").open() as stream:
        return [row | {"seconds": ""} for row in csv.DictReader(stream)]


@pytest.fixture(scope="module")
def whole(tiny_index, tmp_path_factory) -> Path:
    """A run of three steps an epoch, never interrupted."""
    folder = tmp_path_factory.mktemp("whole")
    train_model(tiny_index, OPTIONS, brief(), 0, folder)
    return folder


def test_it_learns_to_reconstruct_held_out_chairs(index, tmp_path):
    train_model(
        index,
        OPTIONS,
        brief(epochs=20, batch_size=2, flow_epochs=0, validate_every=20, kl_weight=0.001),
        0,
        tmp_path,
    )
    store = FieldStore.open(index)
    model = load_generator(tmp_path, store.hierarchy)
    ious = [iou for _, _, iou in reconstruct_fields(model, store, store.ids("validation"), device="cpu")]
    assert np.mean(ious) > 0.5
    assert float(rows(tmp_path)[-1]["validation_iou"]) == pytest.approx(np.mean(ious), abs=1e-4)


def test_the_log_tells_the_stages_apart(whole):
    first, _, third, last = rows(whole)
    assert first["flow_loss"] == "" and float(first["split_loss"]) > 0 and first["validation_iou"] != ""
    assert third["split_loss"] == "" and float(third["flow_loss"]) > 0
    assert float(last["validation_flow_loss"]) > 0


def test_codes_are_standardised_for_the_flow(tiny_index, whole):
    store = FieldStore.open(tiny_index)
    learner = TetflowLearner(OPTIONS, brief(), store, 0)
    learner.generator.load_state_dict(load_generator(whole, store.hierarchy).state_dict())
    codes = learner._encode(learner.data)
    draws = codes.mean + codes.deviation * torch.randn(200, *codes.mean.shape, generator=torch.Generator())
    standard = ((draws - learner.generator.mean) / learner.generator.deviation).flatten(0, 1)
    torch.testing.assert_close(standard.mean(dim=0), torch.zeros(24, 4), rtol=0, atol=0.08)  # 4,800 draws
    torch.testing.assert_close(standard.var(dim=0), torch.ones(24, 4), rtol=0, atol=0.1)


def test_the_flow_takes_the_averaged_autoencoder_and_leaves_it_alone(tiny_index):
    learner = TetflowLearner(OPTIONS, brief(), FieldStore.open(tiny_index), 0)
    network, rows = learner.generator.autoencoder, torch.arange(8)
    for step in range(learner.first_flow_step + 2):
        if step == learner.first_flow_step:
            raw = {name: value.clone() for name, value in network.state_dict().items()}
        learner.take_step(rows, step, 0.0, step_draws(0, step))
    for name, value in network.state_dict().items():
        assert torch.equal(value, learner.autoencoder.average.mean[name])
        assert not torch.equal(value, raw[name])


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(tiny_index, whole, tmp_path):
    for name, seed in (("same", 0), ("other", 1)):
        train_model(tiny_index, OPTIONS, brief(), seed, tmp_path / name)
    assert weights(tmp_path / "same") == weights(whole)
    assert weights(tmp_path / "other") != weights(whole)


class Killed(BaseException):
    """A stand-in for a kill: the loop has no chance to tidy up after it."""


@pytest.mark.parametrize("at", [4, 6, 7, 10], ids=["autoencoder", "between", "flow", "later"])
def test_a_run_that_was_stopped_ends_like_one_that_was_not(tiny_index, whole, tmp_path, monkeypatch, at):
    take_step = TetflowLearner.take_step

    def stop(self, rows, step, *others):
        if step == at:
            raise Killed
        return take_step(self, rows, step, *others)

    with monkeypatch.context() as patch, pytest.raises(Killed):
        patch.setattr(TetflowLearner, "take_step", stop)
        train_model(tiny_index, OPTIONS, brief(checkpoint_seconds=0), 0, tmp_path)
    train_model(tiny_index, OPTIONS, brief(checkpoint_seconds=0), 0, tmp_path)
    assert weights(tmp_path) == weights(whole)
    assert rows(tmp_path) == rows(whole)


def test_draws_depend_on_the_seed_alone(tiny_index, whole):
    store = FieldStore.open(tiny_index)
    model = load_generator(whole, store.hierarchy)
    five = [
        field.displacement for field in generate_fields(model, store, 5, seed=1, batch_size=2, device="cpu")
    ]
    same = [
        field.displacement for field in generate_fields(model, store, 5, seed=1, batch_size=5, device="cpu")
    ]
    other = [field.displacement for field in generate_fields(model, store, 5, seed=2, device="cpu")]
    np.testing.assert_allclose(five, same, atol=1e-4)
    assert not np.allclose(five, other, atol=1e-4)


def test_step_sizes_rise_and_fall(tiny_index):
    learner = TetflowLearner(
        OPTIONS, brief(epochs=10, learning_rate=0.1, warmup=4), FieldStore.open(tiny_index), 0
    )
    assert learner.autoencoder.steps == 30
    # The rise takes a tenth, three steps; half of the way down; the last step.
    rates = [learner.autoencoder.rate_at(step) for step in (0, 15, 30)]
    assert rates == pytest.approx([0.1 / 3, 0.1 * (0.005 + 0.995 / 2), 0.1 * 0.005])


def test_half_precision_gives_nearly_the_same_losses(tiny_index):
    full, half = (
        TetflowLearner(OPTIONS, brief(precision=precision), FieldStore.open(tiny_index), 0)
        for precision in ("fp32", "bf16")
    )
    for step in (0, full.first_flow_step):
        pair = (
            learner.take_step(torch.arange(8), step, 0.0, step_draws(0, step)) for learner in (full, half)
        )
        one, other = ({name: float(value) for name, value in losses.items()} for losses in pair)
        assert one == pytest.approx(other, rel=0.03, abs=1e-3)
        assert one != other
