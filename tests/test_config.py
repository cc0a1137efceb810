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


@pytest.mark.parametrize("name", ["config.yaml", "smoke.yaml", "paper.yaml"])
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
        (changed(samplings={"points": {"kind": "points", "coun": 3}}), ["samplings.points", "count"]),
        (
            changed(models={"m": {"kind": "occnet", "sampling": "voxels-32"}}),
            ["models.m.sampling", "'voxels-32'", "['points']"],
        ),
        (
            changed(models={"m": {"kind": "shapegan-vae", "sampling": "voxels-64"}}),
            ["models.m.sampling", "['voxels-32']"],
        ),
        (changed(models={"m": {"kind": "simplified", "of": "nothing"}}), ["models.m.of", "'nothing'"]),
        (
            changed(models={"m": {"kind": "simplified", "of": "occnet-simplified"}}),
            ["models.m.of", "'occnet-simplified'"],
        ),
        (
            changed(models={"m": {"kind": "occnet", "training": {"epoch": 3}}}),
            ["models.m", "epoch", "epochs"],
        ),
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


def test_reductions_of_baselines_name_their_own_sizes():
    whole = {"kind": "occnet", "mise_start": 32, "mise_steps": 2}
    config = Config.parse(
        changed(
            samplings={"all": {"kind": "points", "count": 100_000}},
            models={
                "whole": whole | {"sampling": "all"},
                "small": {"kind": "occnet", "mise_start": 16, "training": {"epochs": 7, "points": 512}},
                "star": {"kind": "simplified", "of": "small"},
                "gan": {
                    "kind": "shapegan-gan",
                    "sampling": "voxels-32",
                    "training": {"epochs": [3, 2, 1]},
                },
            },
        )
    )
    assert config.reductions("whole") == ""
    assert config.reductions("small") == (
        "points 30000 (paper 100000); points a step 512 (paper 2048); cells a side 64 (paper 128); "
        "epochs 7 (paper 1000)"
    )
    assert config.reductions("star") == config.reductions("small")
    assert config.reductions("gan") == "voxels a side 32 (paper 64); epochs 6 (paper 1000)"
