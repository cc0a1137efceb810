"""The training loop: runs repeat, resume exactly, are saved and loaded, and survive a divergence."""

import csv
import json
from contextlib import contextmanager
from pathlib import Path

import pytest
import torch

from tetgan.errors import UserError
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.methods.occnet.training import OccNetLearner
from tetgan.methods.shapegan.training import ShapeGanLearner
from tetgan.methods.shapegan_vae.training import ShapeGanVaeLearner
from tetgan.models.files import load_generator, load_surface_model, save_generator
from tetgan.models.registry import ModelOptions
from tetgan.options import parse_options
from tetgan.training.learner import Learner
from tetgan.training.loop import TrainingLoop, step_draws
from tetgan.training.run import train_model
from tetgan.training.sections import training_class

KINDS = ("occnet", "shapegan-gan", "shapegan-vae")
BRIEF = {
    "occnet": {"epochs": 4, "batch_size": 2, "points": 64},
    # Two steps at 8³ and four at 16³, all of these blended in; every second is the generator's, too.
    "shapegan-gan": {"epochs": [1, 2], "batch_size": 2, "critic_steps": 2, "fade_in": 4},
    "shapegan-vae": {"epochs": 3, "batch_size": 3},
}


def model(kind: str):
    return parse_options(ModelOptions, {"kind": kind}, kind)


def training(kind: str, **changes):
    return training_class(model(kind)).parse({"device": "cpu"} | BRIEF[kind] | changes)


@pytest.fixture(scope="module")
def learner(points, voxels, coarse_voxels):
    """Makes untrained learners."""
    made_of = {
        "occnet": (OccNetLearner, points),
        "shapegan-gan": (ShapeGanLearner, coarse_voxels),
        "shapegan-vae": (ShapeGanVaeLearner, voxels),
    }

    def make(kind: str, seed: int = 0, **changes):
        sort, store = made_of[kind]
        return sort(model(kind), training(kind, **changes), store, seed)

    return make


@pytest.fixture(scope="module")
def run(learner):
    """Makes runs, which are on the same options as those of `train_model`."""

    def make(kind: str, folder: Path, seed: int = 0, **changes) -> TrainingLoop:
        options = training(kind, **changes)
        return TrainingLoop(
            learner(kind, seed, **changes),
            folder,
            seed,
            options={"training": options.model_dump(exclude=set(options.may_change))},
            validate_every=options.validate_every,
            checkpoint_seconds=options.checkpoint_seconds,
        )

    return make


def finish(run: TrainingLoop, kind: str) -> None:
    """Run to the end and save."""
    run.run(lambda **about: save_generator(run.folder, run.learner.generator, model(kind), **about))


def weights(folder: Path) -> bytes:
    return (folder / "weights.safetensors").read_bytes()


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "log.csv").open() as stream:
        return [row | {"seconds": ""} for row in csv.DictReader(stream)]


@pytest.fixture(scope="module")
def in_one_go(run, tmp_path_factory) -> Path:
    """A folder for each kind, seed 0, never interrupted."""
    folder = tmp_path_factory.mktemp("whole")
    for kind in KINDS:
        finish(run(kind, folder / kind), kind)
    return folder


@pytest.mark.parametrize("kind", ["occnet", "shapegan-vae"])
def test_training_from_an_index_repeats_every_byte(indexes, in_one_go, tmp_path, kind):
    train_model(indexes[kind], model(kind), training(kind), 0, tmp_path)
    assert weights(tmp_path) == weights(in_one_go / kind)
    record = json.loads((tmp_path / "options.json").read_text())
    assert record["model"]["kind"] == kind
    assert record["training"]["batch_size"] == BRIEF[kind]["batch_size"]
    assert record["seed"] == 0


class Killed(BaseException):
    """A stand-in for a kill: the loop has no chance to tidy up after it."""


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_that_was_stopped_ends_like_one_that_was_not(run, in_one_go, tmp_path, kind):
    stopped = run(kind, tmp_path, checkpoint_seconds=0)
    take_step = stopped.learner.take_step

    def stop(rows, step, *others):
        if step == 3:  # within an epoch
            raise Killed
        return take_step(rows, step, *others)

    stopped.learner.take_step = stop
    with pytest.raises(Killed):
        finish(stopped, kind)
    assert not (tmp_path / "weights.safetensors").exists()
    finish(run(kind, tmp_path, checkpoint_seconds=0), kind)
    assert weights(tmp_path) == weights(in_one_go / kind)
    assert rows(tmp_path) == rows(in_one_go / kind)


@pytest.mark.parametrize("kind", KINDS)
def test_a_seed_starts_with_the_same_weights_and_another_does_not(learner, kind):
    first, same, other = (learner(kind, seed).generator.state_dict() for seed in (0, 0, 1))
    assert all(torch.equal(first[name], same[name]) for name in first)
    assert not all(torch.equal(first[name], other[name]) for name in first)


@pytest.mark.parametrize("kind", KINDS)
def test_a_trained_model_is_loaded_without_a_grid(in_one_go, kind):
    loaded = load_surface_model(in_one_go / kind)
    assert not loaded.training
    assert loaded.latent_shape == (128,)
    assert json.loads((in_one_go / kind / "options.json").read_text())["diverged_in_epoch"] is None


def test_a_trained_occnet_knows_how_many_points_it_encodes(in_one_go):
    assert load_surface_model(in_one_go / "occnet").encoded == BRIEF["occnet"]["points"]


def test_a_model_of_the_wrong_sort_is_named(in_one_go):
    with pytest.raises(UserError, match="occnet, which has no fields"):
        load_generator(in_one_go / "occnet", build_hierarchy(1, 0))


def test_the_log_has_the_columns_of_the_model(in_one_go):
    occnet, gan = rows(in_one_go / "occnet"), rows(in_one_go / "shapegan-gan")
    assert list(occnet[0]) == [
        *("epoch", "seconds", "reconstruction_loss", "kl", "validation_iou", "validation_accuracy")
    ]
    assert [row["validation_iou"] != "" for row in occnet] == [False, False, False, True]  # the last at least
    assert [row["resolution"] for row in gan] == ["8", "16", "16"]
    assert [row["fade"] for row in gan] == ["1", "0.0625", "0.3125"]  # means of 0, ⅛, and of ¼, ⅜


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_that_diverges_keeps_the_weights_before_and_says_so(run, tmp_path, caplog, kind):
    poisoned = run(kind, tmp_path)
    generator, take_step, kept = poisoned.learner.generator, poisoned.learner.take_step, {}

    def poison(rows, step, *others):
        losses = take_step(rows, step, *others)
        if step == 1:  # the last of the first epoch
            kept.update({name: value.clone() for name, value in generator.state_dict().items()})
        elif step == 3:
            with torch.no_grad():
                next(generator.parameters()).fill_(torch.nan)
        return losses

    poisoned.learner.take_step = poison
    finish(poisoned, kind)
    assert "diverged in epoch 2" in caplog.text
    assert json.loads((tmp_path / "options.json").read_text())["diverged_in_epoch"] == 2
    assert len(rows(tmp_path)) == 2
    loaded = load_surface_model(tmp_path).state_dict()
    assert all(torch.equal(loaded[name], value) for name, value in kept.items())


def test_an_infinite_loss_is_a_divergence_too(run, tmp_path):
    subject = run("occnet", tmp_path)
    take_step = subject.learner.take_step
    subject.learner.take_step = lambda rows, step, *others: (
        take_step(rows, step, *others) | ({"kl": float("inf")} if step == 5 else {})
    )
    finish(subject, "occnet")
    assert json.loads((tmp_path / "options.json").read_text())["diverged_in_epoch"] == 3


def test_a_first_epoch_that_diverges_is_an_error_and_nothing_is_saved(run, tmp_path):
    with pytest.raises(UserError, match="diverged in its first epoch; lower learning_rate"):
        finish(run("occnet", tmp_path, learning_rate=1e30), "occnet")
    assert not (tmp_path / "weights.safetensors").exists()


def test_each_epoch_takes_every_shape_once_in_parts_of_a_size(run, tmp_path):
    subject = run("shapegan-vae", tmp_path)
    orders = [subject.rows(step).tolist() for step in range(4)]
    assert [len(part) for part in orders] == [2, 2, 2, 2]  # four shapes, three a batch at most
    assert sorted(orders[0] + orders[1]) == sorted(orders[2] + orders[3]) == [0, 1, 2, 3]


class Counter(Learner):
    """Counts steps; the weights are 1, those that are kept on average 7."""

    losses = ("loss",)
    data_digest = ""
    shapes, epochs, batch_size = 5, 2, 2

    def __init__(self):
        self.generator = torch.nn.Linear(1, 1)
        self.seen, self.finished = [], []
        torch.nn.init.ones_(self.generator.weight)

    def batches(self, order):
        return order.split(self.batch_size)

    def start(self, step, rows):
        self.ahead = [rows(later).tolist() for later in range(step, 6)]

    def take_step(self, rows, step, epoch, draws):
        self.seen.append((rows.tolist(), step, epoch))
        return {"loss": float(step)}

    @contextmanager
    def averaged(self):
        torch.nn.init.constant_(self.generator.weight, 7)
        yield
        torch.nn.init.ones_(self.generator.weight)

    def finish_epoch(self, epoch, last, folder):
        self.finished.append((epoch, last, self.generator.weight.item()))
        return {}

    def finish(self):
        self.finished.append(self.generator.weight.item())

    def parts(self):
        return {}


def test_a_learner_cuts_epochs_reads_ahead_and_saves_its_averages(tmp_path):
    learner, saved = Counter(), []
    TrainingLoop(learner, tmp_path, 0, options={}).run(lambda **about: saved.append(about))
    rows, steps, epochs = zip(*learner.seen, strict=True)
    assert [len(part) for part in rows] == [2, 2, 1, 2, 2, 1]
    assert list(rows) == learner.ahead
    assert steps == (0, 1, 2, 3, 4, 5)
    assert epochs == (0, 1 / 3, 2 / 3, 1, 4 / 3, 5 / 3)
    assert learner.finished == [(1, False, 1), (2, True, 1), 7]
    assert [about["diverged_in_epoch"] for about in saved] == [None]


def test_the_numbers_of_a_step_depend_on_seed_and_step_alone():
    first, same, other, later = (
        torch.rand(3, generator=step_draws(*place)) for place in ((0, 4), (0, 4), (1, 4), (0, 5))
    )
    assert torch.equal(first, same)
    assert not torch.equal(first, other) and not torch.equal(first, later)
