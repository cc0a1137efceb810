"""Training options of each kind of model."""

import pytest

from tetgan.errors import UserError
from tetgan.methods.tetgan.options import TetganTraining
from tetgan.models.registry import ModelOptions
from tetgan.options import parse_options
from tetgan.training.options import training_options

COMMON = TetganTraining(epochs=7, learning_rate=0.5, device="cpu", validate_every=3)


def options_of(**model):
    return training_options(parse_options(ModelOptions, model, "model"), COMMON)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("occnet", {"learning_rate": 1e-4, "batch_size": 64, "points": 2048}),
        (
            "shapegan-gan",
            {"learning_rate": 1e-4, "batch_size": 16, "epochs": 250, "gradient_penalty": 10.0}
            | {"critic_steps": 5, "fade_in": 10.0},
        ),
        ("shapegan-vae", {"learning_rate": 5e-5, "batch_size": 32, "inside_weight": 32.0}),
    ],
)
def test_a_baseline_has_its_own_hyperparameters(kind, expected):
    values = options_of(kind=kind).model_dump()
    assert expected.items() <= values.items()
    assert (values["device"], values["validate_every"]) == ("cpu", 3)  # these are common


def test_a_model_s_own_options_come_last():
    assert options_of(kind="occnet", training={"epochs": 9, "device": "auto"}).model_dump()["epochs"] == 9
    assert options_of(kind="tetgan", grid="LR", training={"epochs": 9}).model_dump()["learning_rate"] == 0.5


@pytest.mark.parametrize("kind", ["occnet", "shapegan-gan", "shapegan-vae"])
def test_an_option_of_another_kind_is_an_error_naming_it(kind):
    with pytest.raises(UserError, match=r"training: local_weight: unknown key"):
        options_of(kind=kind, training={"local_weight": 1.0})
