"""Training options of each kind of model."""

import pytest

from tetgan.errors import UserError
from tetgan.models.registry import ModelOptions
from tetgan.options import parse_options
from tetgan.training.sections import TrainingSections, training_options

SECTIONS = {
    "common": {"device": "cpu", "validate_every": 3},
    "tetgan": {"epochs": 7, "learning_rate": 0.5},
    "deftet": {"validate_every": 2},
}


def options_of(**model):
    return training_options(parse_options(ModelOptions, model, "model"), SECTIONS)


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
    assert options_of(kind="occnet", training={"epochs": 9, "device": "auto"}).epochs == 9
    own = options_of(kind="tetgan", grid="LR", training={"epochs": 9})
    assert (own.epochs, own.learning_rate, own.device) == (9, 0.5, "cpu")
    other = options_of(kind="deftet", grid="LR", of="full")
    assert (other.epochs, other.learning_rate) == (100, 1e-4)  # its own defaults, not TetGAN's section
    assert (other.device, other.validate_every) == ("cpu", 2)


@pytest.mark.parametrize("kind", ["occnet", "shapegan-gan", "shapegan-vae"])
def test_an_option_of_another_kind_is_an_error_naming_it(kind):
    with pytest.raises(UserError, match=r"training: local_weight: unknown key"):
        options_of(kind=kind, training={"local_weight": 1.0})


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"tetgn": {}}, "tetgn: unknown key; did you mean 'tetgan'"),
        ({"pca": {}}, "pca: unknown key"),  # nothing is trained in steps
        ({"tetgan": {"epoch": 3}}, "tetgan.epoch: unknown key; did you mean 'epochs'"),
        ({"deftet": {"local_weight": 1.0}}, "deftet.local_weight: unknown key"),
        ({"common": {"epochs": 3}}, "common.epochs: unknown key"),
        ({"occnet": {"epochs": 0}}, "occnet.epochs: .* greater than or equal to 1"),
        ({"occnet": None}, "occnet: .* dictionary"),
    ],
)
def test_a_mistake_in_the_section_is_named(values, words):
    with pytest.raises(UserError, match=words):
        parse_options(TrainingSections, values, "training")


def test_the_section_keeps_what_is_given_and_no_defaults():
    assert parse_options(TrainingSections, SECTIONS, "training") == SECTIONS
