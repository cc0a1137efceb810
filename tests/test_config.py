"""The configuration: defaults are filled, and every mistake is one line that names its key."""

import copy
from pathlib import Path

import pytest
import yaml
from snakemake.utils import update_config

from tetgan.config import PAPER, Config, load_config, schema_text
from tetgan.errors import UserError

ROOT = Path(__file__).parent.parent
DEFAULT = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())


def changed(**sections):
    """The default configuration with some keys of its sections replaced."""
    values = copy.deepcopy(DEFAULT)
    for name, part in sections.items():
        values[name] = values.get(name, {}) | part if isinstance(part, dict) else part
    return values


@pytest.mark.parametrize("name", sorted(path.name for path in (ROOT / "config").glob("*.yaml")))
def test_shipped_configurations_are_valid_on_top_of_the_default(name):
    values = copy.deepcopy(DEFAULT)
    update_config(values, yaml.safe_load((ROOT / "config" / name).read_text()))
    assert load_config(load_config(values)) == load_config(values)


def test_the_written_schema_is_in_step():
    assert (ROOT / "workflow" / "schemas" / "config.schema.yaml").read_text() == schema_text()


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (changed(trainig={}), ["trainig", "did you mean 'training'"]),
        (changed(training={"epoch": 3}), ["training.epoch", "did you mean 'epochs'"]),
        (changed(training={"epochs": 0}), ["training.epochs", "greater than or equal to 1"]),
        (changed(categories=["lamp"]), ["'lamp' has no entry under sources"]),
        (changed(sources={"chair": {"kind": "magic"}}), ["sources.chair", "magic"]),
        (changed(grids={"LR": {"depth": 2}}), ["grids.LR", "exactly one of 'cells' and 'file'"]),
        (changed(models={"m": {"kind": "pca", "grid": "XR"}}), ["models.m.grid", "XR"]),
        (
            changed(models={"m": {"kind": "tetgan", "grid": "LR", "training": {"epoch": 3}}}),
            ["models.m", "epoch", "epochs"],
        ),
        (changed(sources={"../evil": {"kind": "builtin"}}), ["../evil"]),
        (changed(sources={"fid": {"kind": "builtin"}}), ["'fid' is the name of a table"]),
    ],
)
def test_a_mistake_is_one_line_naming_its_key(values, words):
    with pytest.raises(UserError) as error:
        load_config(values)
    message = str(error.value)
    assert "\n" not in message
    for word in words:
        assert word in message


def test_a_model_overrides_the_common_training_options():
    config = Config.parse(
        changed(
            training={"epochs": 7, "batch_size": 3},
            models={"m": {"kind": "tetgan", "grid": "LR", "training": {"epochs": 9}}},
        )
    )
    assert (config.training_of("m").epochs, config.training_of("m").batch_size) == (9, 3)


def test_an_entry_of_another_kind_drops_what_the_default_said_of_its_own():
    values = copy.deepcopy(DEFAULT)
    update_config(values, {"sources": {"chair": {"kind": "directory", "path": "my/chairs"}}})
    assert "count" in values["sources"]["chair"]  # Snakemake keeps it
    chair = load_config(values)["sources"]["chair"]
    assert (chair["kind"], chair["path"]) == ("directory", "my/chairs")
    values["sources"]["chair"]["pth"] = "my/chairs"
    with pytest.raises(UserError, match=r"pth: unknown key; did you mean 'path'"):
        load_config(values)


def test_reductions_name_what_is_smaller_than_in_the_paper():
    config = Config.parse(changed(models={"m": {"kind": "tetgan", "grid": "LR", "width": 16}}))
    assert f"width 16 (paper {PAPER['width']})" in config.reductions("m")
    assert "depth 2 (paper 3)" in config.reductions("m")
    assert "code" not in config.reductions("m")
