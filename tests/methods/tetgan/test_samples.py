"""Draws of the prior of a TetGAN that has trained for seconds resemble its chairs."""

from typing import NamedTuple

import numpy as np
import pytest
import torch

from tetgan.fields.store import FieldStore
from tetgan.geometry.components import connect_tets
from tetgan.methods.tetgan import training as trainer_module
from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.models.files import load_generator
from tetgan.models.iou import occupancy_iou
from tetgan.models.sampling import generate_fields
from tetgan.training.run import train_model

MODEL = {"grid": "small", "width": 6, "base_width": 24, "prior": "fitted", "displacement_range": 0.5}
CRITICS = {"local_critic_width": 1, "global_critic_width": 2}
TRAINING = {
    **{"batch_size": 4, "learning_rate": 2e-3, "betas": [0.9, 0.99], "decay": "cosine", "device": "cpu"},
    **{"kl_weight": 0.005, "kl_decay": 0.0, "picture_every": 1000, "validate_every": 1000},
    **{"local_weight": 0.01, "adversarial_start": 0.75, "adversarial_every": 12},
}
DRAWS = 24


class Drawn(NamedTuple):
    """Occupancy of draws of a trained model and of one that is not, and of real shapes, each (N, T)."""

    store: FieldStore
    trained: np.ndarray
    untrained: np.ndarray
    held_out: np.ndarray
    train: np.ndarray


@pytest.fixture(
    scope="module",
    params=[
        ({"latent": "global", "code": 16}, 30),
        pytest.param(({"latent": "tet", "code": 8}, 60), marks=pytest.mark.slow),
    ],
    ids=["global", "tet"],
)
def drawn(request, index, tmp_path_factory) -> Drawn:
    latent, epochs = request.param
    folder, store = tmp_path_factory.mktemp("samples"), FieldStore.open(index)
    options = TetganOptions.parse(MODEL | CRITICS | latent)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(trainer_module, "draw_decoded", lambda *_: None)
        train_model(index, options, TetganTraining.parse(TRAINING | {"epochs": epochs}), 0, folder)
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        untrained = TetganGenerator(options, store.hierarchy)
    draws = [
        np.stack([field.occupancy for field in generate_fields(model, store, DRAWS, seed=0, device="cpu")])
        for model in (load_generator(folder, store.hierarchy), untrained)
    ]
    real = [store.stack(store.ids(split)).occupancy for split in ("validation", "train")]
    return Drawn(store, *draws, *real)


def nearest_iou(drawn: np.ndarray, real: np.ndarray) -> float:
    """Mean over the real shapes of the IoU with the draw that is most like each."""
    return float(np.mean([occupancy_iou(drawn, np.broadcast_to(shape, drawn.shape)).max() for shape in real]))


def test_draws_are_as_full_as_real_chairs(drawn):
    real, got = drawn.train.mean(axis=1), drawn.trained.mean(axis=1)
    assert got.min() > real.min() / 2
    assert got.max() < 2 * real.max()


def test_draws_are_in_few_pieces(drawn):
    tets = drawn.store.hierarchy.finest.tets
    counts = [connect_tets(tets[occupied]).component.max() + 1 for occupied in drawn.trained]
    # Real chairs on this grid have 1 to 6; untrained draws about 37.
    assert max(counts) <= 10
    assert np.median(counts) <= 5


def test_draws_are_nearer_to_held_out_chairs_than_untrained_ones(drawn):
    assert nearest_iou(drawn.trained, drawn.held_out) > 0.25 + nearest_iou(drawn.untrained, drawn.held_out)


def test_draws_vary_half_as_much_as_real_chairs(drawn):
    real, got = (occupancy.std(axis=0).mean() for occupancy in (drawn.train, drawn.trained))
    assert got > real / 2
