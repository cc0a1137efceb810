"""The configuration: defaults are filled, and every mistake is one line that names its key."""

import copy
from pathlib import Path

import pytest
import yaml
from snakemake.utils import update_config

from tetgan.config import Config, load_config, schema_text
from tetgan.errors import UserError

ROOT = Path(__file__).parent.parent
DEFAULT = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())


def changed(**sections):
    """The default configuration with some keys of its sections replaced."""
    values = copy.deepcopy(DEFAULT)
    for name, part in sections.items():
        values[name] = values.get(name, {}) | part if isinstance(part, dict) else part
    return values


def test_models_of_fields_are_meshed_in_every_mode():
    settings = Config.parse(load_config(DEFAULT))
    modes = {name: settings.modes_of(name) for name in settings.models}
    assert modes["tetgan-LR"] == modes["representation-HR"] == ["paper", "solid"]
    for name in ("pca-16", "surface-gcn", "occnet", "occnet-simplified"):
        assert modes[name] == ["paper"]
    assert (settings.shown_mode("tetgan-LR"), settings.shown_mode("pca-16")) == ("solid", "paper")
    settings = Config.parse(load_config(changed(modes=["solid"])))
    assert (settings.modes_of("pca-16"), settings.shown_mode("occnet")) == (["solid"], "solid")


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
        (changed(training={"tetgan": {"epoch": 3}}), ["training.tetgan.epoch", "did you mean 'epochs'"]),
        (
            changed(training={"tetgan": {"epochs": 0}}),
            ["training.tetgan.epochs", "greater than or equal to 1"],
        ),
        (changed(training={"tetgn": {}}), ["training.tetgn", "did you mean 'tetgan'"]),
        (changed(training={"epochs": 3}), ["training.epochs", "unknown key"]),
        (changed(training={"common": {"epochs": 3}}), ["training.common.epochs", "unknown key"]),
        (changed(training={"deftet": {"kl_weight": 1}}), ["training.deftet.kl_weight", "unknown key"]),
        (changed(categories=["lamp"]), ["'lamp' has no entry under sources"]),
        (changed(sources={"chair": {"kind": "magic"}}), ["sources.chair", "magic"]),
        (changed(grids={"LR": {"depth": 2}}), ["grids.LR", "exactly one of 'cells' and 'file'"]),
        (changed(models={"m": {"kind": "pca", "grid": "XR"}}), ["models.m.grid", "XR"]),
        (changed(models={"m": {"kind": "magic"}}), ["models.m.kind", "'magic'", "pca", "tetgan", "plugins"]),
        (changed(models={"m": {"grid": "LR"}}), ["models.m.kind", "a model needs the name of its method"]),
        (changed(models={"m": ["pca"]}), ["models.m.kind", "a model needs the name of its method"]),
        (changed(figures={"models": ["tetgan-XR"]}), ["figures.models", "'tetgan-XR'", "tetgan-LR"]),
        (changed(figures={"models": ["occnet"]}), ["figures.models", "'occnet' is no model of fields"]),
        (changed(studies={"smoothing": {"models": ["occnet"]}}), ["studies.smoothing.models", "'occnet'"]),
        (changed(plugins="toys"), ["plugins", "valid list"]),
        (changed(plugins=["toys/linear.py"]), ["plugins", "'toys/linear.py' is no dotted name of a module"]),
        (changed(plugins=["absent_toys.linear"]), ["plugins", "No module named 'absent_toys'", "PYTHONPATH"]),
        (changed(plugins=["json"]), ["plugins: json", "holds no Method"]),
        (
            changed(models={"m": {"kind": "tetgan", "grid": "LR", "training": {"epoch": 3}}}),
            ["models.m", "epoch", "epochs"],
        ),
        (changed(models={"m": {"inherit": "tetgan-XR"}}), ["models.m.inherit", "'tetgan-XR' is no model"]),
        (changed(models={"m": {"inherit": "n"}, "n": {"inherit": "m"}}), ["models.m.inherit", "m -> n -> m"]),
        (changed(models={"m": {"inherit": "tetgan-LR", "convoluton": "tet"}}), ["models.m", "'convolution'"]),
        (changed(models={"m": {"inherit": "tetgan-LR", "meshing": {"gama": 3}}}), ["models.m", "'gamma'"]),
        (changed(models={"m": {"inherit": "tetgan-LR", "meshing": {"gamma": 0}}}), ["models.m", "gamma"]),
        (changed(ablation=["tetgan-XR"]), ["ablation", "'tetgan-XR' has no entry under models"]),
        (changed(models={"m": {"kind": "deftet", "grid": "LR", "of": "pca-16"}}), ["models.m.of", "pca-16"]),
        (
            changed(models={"m": {"kind": "deftet", "grid": "HR", "of": "tetgan-LR"}}),
            ["models.m.of", "on grid LR, not HR"],
        ),
        (changed(sources={"../evil": {"kind": "builtin"}}), ["../evil"]),
        (changed(sources={"fid": {"kind": "builtin"}}), ["'fid' is the name of a table"]),
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
        (changed(models={"m": {"like": "tetgan-LR"}}), ["models.m.like", "called 'inherit'"]),
        (changed(sampling={"count": 3}), ["config: sampling", "called 'samples'"]),
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
            training={"tetgan": {"epochs": 7, "batch_size": 3}},
            models={"m": {"kind": "tetgan", "grid": "LR", "training": {"epochs": 9}}},
        )
    )
    assert (config.training_of("m").epochs, config.training_of("m").batch_size) == (9, 3)


def test_a_model_like_another_says_only_what_differs():
    models = {
        "m": {"inherit": "tetgan-LR", "width": 3, "training": {"epochs": 9}},
        "n": {"inherit": "m", "code": 5},
    }
    config = Config.parse(changed(models=models))
    full = config.models["tetgan-LR"]
    assert config.models["m"] == full.model_copy(
        update={"width": 3, "training": full.training | {"epochs": 9}}
    )
    assert config.models["n"] == config.models["m"].model_copy(update={"code": 5})


def test_what_a_later_file_says_of_a_model_holds_for_those_like_it():
    values = changed(models={"m": {"inherit": "tetgan-LR", "pool": "mean"}})
    update_config(values, {"models": {"tetgan-LR": {"width": 3}}})
    assert load_config(values)["models"]["m"]["width"] == 3


def test_an_empty_entry_drops_a_model():
    values = load_config(changed(models={"pca-16": None}))
    assert "pca-16" not in values["models"]
    assert "pca-64" in values["models"]


def test_models_of_the_ablation_stand_in_its_table_alone_but_for_the_full_one():
    config = Config.parse(changed(ablation=["tetgan-LR", "tet-gcn"]))
    assert "tet-gcn" not in config.table_models
    assert {"tetgan-LR", "no-local"} <= set(config.table_models)
    everything = Config.parse(changed(ablation=[])).table_models
    assert sorted(everything) == sorted(config.models)
    kinds = [config.models[name].kind for name in everything]
    bounds = [kind in ("representation", "pca") for kind in kinds]
    assert any(bounds) and bounds == sorted(bounds)  # the bounds come last


def test_changes_tell_what_an_ablation_differs_in():
    config = Config.parse(DEFAULT)
    told = {name: config.changes(name) for name in config.ablation}
    assert told["tetgan-LR"] == ""
    assert told["tet-gcn"] == "convolution shared (full: tet)"
    assert told["no-filter"] == "gamma off (full: 4.0)"
    assert told["occupancy-only"] == "displacement no (full: yes)"
    assert told["no-local"].startswith("local_weight 0.0 (full: ")
    assert told["official-weights"].split("; ")[1].startswith("global_weight -0.01")
    assert told["surface-gcn"] == "kind deftet; of tetgan-LR; width 64; blocks 3"
    assert all(told[name] for name in config.ablation[1:])


def test_models_that_are_meshed_differently_share_their_training():
    config = Config.parse(DEFAULT)
    assert config.trained_as("no-filter") == "tetgan-LR"
    assert config.meshing_of("no-filter").gamma is None
    assert config.meshing_of("tetgan-LR").gamma == 4.0
    for name in config.models:
        assert name == "no-filter" or config.trained_as(name) == name


def test_ablations_of_the_default_train_as_long_as_the_full_model():
    config = Config.parse(DEFAULT)
    for name in config.ablation:
        assert config.models[name].grid == "LR"
        if name != "surface-gcn":  # whose network is far smaller
            assert config.training_of(name).epochs == config.training_of("tetgan-LR").epochs


def test_an_entry_of_another_kind_drops_what_the_default_said_of_its_own():
    values = copy.deepcopy(DEFAULT)
    update_config(values, {"sources": {"chair": {"kind": "directory", "path": "my/chairs"}}})
    assert "count" in values["sources"]["chair"]  # Snakemake keeps it
    chair = load_config(values)["sources"]["chair"]
    assert (chair["kind"], chair["path"]) == ("directory", "my/chairs")
    values["sources"]["chair"]["pth"] = "my/chairs"
    with pytest.raises(UserError, match=r"pth: unknown key; did you mean 'path'"):
        load_config(values)


def test_nothing_of_the_paper_configuration_is_smaller_than_the_paper():
    values = copy.deepcopy(DEFAULT)
    update_config(values, yaml.safe_load((ROOT / "config" / "paper.yaml").read_text()))
    config = Config.parse(load_config(values))
    assert {name: config.reductions(name) for name in config.models if config.reductions(name)} == {}
    for name in ("occnet", "shapegan-gan", "shapegan-vae"):  # as public, to the last option
        own, public = config.training_of(name), type(config.training_of(name))()
        assert own == public.model_copy(update={"validate_every": own.validate_every})


def test_critics_that_a_tetgan_lacks_are_read_from_its_training():
    config = Config.parse(load_config(DEFAULT))
    without = {name: config.without(name) for name in config.models}
    assert {name: critics for name, critics in without.items() if critics} == {
        "no-local": ["local"],
        "no-global": ["global"],
        "vae-only": ["local", "global"],
    }


def test_reductions_name_what_is_smaller_than_in_the_paper():
    config = Config.parse(changed(models={"m": {"kind": "tetgan", "grid": "LR", "width": 16}}))
    assert "width 16 (paper 64)" in config.reductions("m")
    assert "depth 2 (paper 3)" in config.reductions("m")
    assert "code" not in config.reductions("m") and "prior" not in config.reductions("m")
    config = Config.parse(changed(models={"m": {"kind": "tetgan", "grid": "LR", "prior": "fitted"}}))
    assert "prior fitted (paper normal)" in config.reductions("m")


def test_reductions_of_baselines_name_their_own_sizes():
    whole = {"kind": "occnet", "mise_start": 32, "mise_steps": 2}
    config = Config.parse(
        changed(
            samplings={"all": {"kind": "points", "count": 100_000}},
            models={
                "whole": whole | {"sampling": "all"},
                "small": {"kind": "occnet", "mise_start": 16, "training": {"epochs": 7, "points": 512}},
                "star": {"kind": "simplified", "of": "small"},
                "coarse": {"kind": "simplified", "of": "small", "faces": 300},
                "gan": {
                    "kind": "shapegan-gan",
                    "sampling": "voxels-32",
                    "training": {"epochs": [3, 2, 1], "fade_in": 0.5},
                },
            },
        )
    )
    assert config.reductions("whole") == ""
    assert config.reductions("small") == (
        "points 30000 (paper 100000); points a step 512 (paper 2048); cells a side 64 (paper 128); "
        "epochs 7 (our full run 1000)"
    )
    assert config.reductions("star") == config.reductions("small")
    assert config.reductions("coarse") == config.reductions("small") + "; faces 300 (paper 5500)"
    assert config.reductions("gan") == (
        "voxels a side 32 (paper 64); epochs 6 (paper 1000); fade-in epochs 0.5 (paper 10)"
    )


def test_an_ablation_of_a_models_weights_has_its_sizes_and_training_of_its_own():
    models = {
        "full": {"kind": "tetgan", "grid": "LR", "width": 16, "training": {"epochs": 50}},
        "gcn": {"kind": "deftet", "grid": "LR", "of": "full", "training": {"epochs": 60}},
    }
    config = Config.parse(changed(models=models))
    assert "epochs 50 (paper 100)" in config.reductions("full")
    assert config.reductions("gcn") == config.reductions("full").replace("epochs 50", "epochs 60")
