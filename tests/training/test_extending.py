"""The model of docs/extending.md: found, trained, resumed, sampled and measured like those that are here."""

import csv
import importlib
import json
import sys
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner
from worked_example import CONFIG, MODULE, write_module

from tetgan.cli.app import app
from tetgan.config import Config, load_config, schema_text
from tetgan.errors import UserError
from tetgan.models import registry
from tetgan.models.registry import ModelOptions, find_method, load_plugins
from tetgan.options import parse_options
from tetgan.training.loop import KindTrainer
from tetgan.training.run import train_model
from tetgan.training.sections import training_class

NAME = "my_models.linear"
DEFAULT = yaml.safe_load((Path(__file__).parents[2] / "config" / "config.yaml").read_text())
BRIEF = {"epochs": 6, "batch_size": 6, "device": "cpu"}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch) -> Path:
    """Holds the module, is on the path, and is forgotten with all kinds that came of it."""
    write_module(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(registry, "_loaded", dict(registry._loaded))
    yield tmp_path
    for name in ("my_models", NAME):
        sys.modules.pop(name, None)


def laid_over_the_default(**changes) -> dict:
    return DEFAULT | CONFIG | changes | {"models": DEFAULT["models"] | CONFIG["models"]}


def train(index: Path, out: Path, **changes) -> Path:
    options = parse_options(ModelOptions, {"kind": "linear", "grid": "LR"}, "model")
    train_model(index, options, training_class(options).parse(BRIEF | changes), 0, out)
    return out


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open() as stream:
        return list(csv.DictReader(stream))


def test_the_document_shows_it_in_forty_lines():
    assert sum(bool(line.strip()) for line in MODULE.splitlines()) <= 40


def test_a_config_that_names_the_module_knows_the_kind():
    config = Config.parse(load_config(laid_over_the_default()))
    assert config.models["linear"].code == 16
    assert config.training_of("linear").model_dump() == {
        **{"epochs": 40, "batch_size": 4, "learning_rate": 1e-3},
        **{"device": "auto", "validate_every": 4, "checkpoint_seconds": 120.0},  # common ones
    }
    assert config.reductions("linear") == "depth 2 (paper 3)"
    assert "linear" in config.table_models


def test_a_mistake_in_it_is_one_line_naming_the_key():
    values = laid_over_the_default()
    values["models"]["linear"] = {"kind": "linear", "grid": "LR", "cod": 3}
    with pytest.raises(UserError, match=r"models.linear.cod: unknown key; did you mean 'code'") as error:
        load_config(values)
    assert "\n" not in str(error.value)
    values["models"]["linear"] = {"kind": "linear", "grid": "LR", "training": {"epoch": 3}}
    with pytest.raises(UserError, match=r"models.linear.training: epoch: unknown key; did you mean 'epochs'"):
        load_config(values)


def test_without_the_module_the_kind_is_unknown():
    with pytest.raises(UserError, match=r"models.linear.kind: 'linear' is no method; there are deftet, "):
        load_config(laid_over_the_default(plugins=[]))


def test_the_schema_knows_the_kind_once_the_module_is_named():
    assert "LinearOptions" not in schema_text()
    load_plugins([NAME])
    assert "LinearOptions" in schema_text()


def test_naming_a_module_twice_is_no_clash_but_another_of_the_same_kind_is(folder):
    load_plugins([NAME, NAME])
    (folder / "my_models" / "other.py").write_text(MODULE)
    with pytest.raises(UserError, match=r"my_models.other: there is a method 'linear' already"):
        load_plugins(["my_models.other"])


def test_a_kind_of_this_package_cannot_be_replaced(folder):
    (folder / "my_models" / "fake.py").write_text(MODULE.replace('"linear"', '"pca"'))
    with pytest.raises(UserError, match="there is a method 'pca' already"):
        load_plugins(["my_models.fake"])


def test_an_error_in_the_module_shows_its_traceback(folder):
    (folder / "my_models" / "torn.py").write_text("1 / 0")
    with pytest.raises(ZeroDivisionError):
        load_plugins(["my_models.torn"])


def declare(folder: Path, entry: str) -> None:
    """What pip leaves of an installed package that declares an entry point."""
    about = folder / "my_models-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: my-models\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(f"[tetgan.methods]\n{entry}\n")
    importlib.invalidate_caches()


def test_an_installed_package_needs_no_naming(folder):
    declare(folder, f"linear = {NAME}:METHOD")
    with pytest.raises(UserError, match="deftet, linear, occnet"):
        find_method("magic")
    assert NAME not in sys.modules  # it is imported only when it is asked for
    assert load_config(laid_over_the_default(plugins=[]))["models"]["linear"]["code"] == 16


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ("linear = my_models.absent:METHOD", "No module named 'my_models.absent'"),
        (f"linear = {NAME}:OTHER", "OTHER"),
        (f"linear = {NAME}:LinearOptions", "no Method of that name"),
        (f"curved = {NAME}:METHOD", "no Method of that name"),
    ],
)
def test_a_broken_entry_point_is_named(folder, entry, words):
    declare(folder, entry)
    name = entry.split()[0]
    with pytest.raises(UserError, match=f"entry point {name} of tetgan.methods: .*{words}"):
        find_method(name)


def test_it_learns_and_logs(index, tmp_path):
    load_plugins([NAME])
    out = train(index, tmp_path / "model", epochs=40)
    rows = rows_of(out / "log.csv")
    assert list(rows[0]) == ["epoch", "seconds", "occupancy_loss", "displacement_loss", "validation_iou"]
    assert float(rows[-1]["occupancy_loss"]) < 0.5 * float(rows[0]["occupancy_loss"])
    measured = [float(row["validation_iou"]) for row in rows if row["validation_iou"]]
    assert len(measured) == 4 and measured[-1] > measured[0]
    record = json.loads((out / "options.json").read_text())
    assert record["model"] == {"kind": "linear", "grid": "LR", "code": 16, "training": {}}
    assert record["grid_digest"]


def test_a_run_that_was_stopped_ends_like_one_that_was_not(tiny_index, tmp_path, monkeypatch):
    load_plugins([NAME])
    whole = train(tiny_index, tmp_path / "whole", checkpoint_seconds=0)
    take_step = KindTrainer.take_step

    def stop(self, draws):
        if self.step == 7:  # within an epoch
            raise KeyboardInterrupt
        return take_step(self, draws)

    monkeypatch.setattr(KindTrainer, "take_step", stop)
    with pytest.raises(KeyboardInterrupt):
        train(tiny_index, tmp_path / "stopped", checkpoint_seconds=0)
    monkeypatch.setattr(KindTrainer, "take_step", take_step)
    train(tiny_index, tmp_path / "stopped", checkpoint_seconds=0)
    one, other = ((part / "weights.safetensors").read_bytes() for part in (whole, tmp_path / "stopped"))
    assert one == other


def command(*arguments: object) -> None:
    result = CliRunner().invoke(app, [str(argument) for argument in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output


def test_the_command_line_trains_samples_and_measures_it(index, tmp_path, monkeypatch):
    training = json.dumps(BRIEF | {"epochs": 20})
    monkeypatch.chdir(tmp_path)
    command(
        "--plugin",
        NAME,
        "train",
        index,
        "model",
        "--model",
        "{kind: linear, grid: LR}",
        "--training",
        training,
    )
    monkeypatch.setenv("TETGAN_PLUGINS", NAME)
    command("sample", "model", "samples", "--index", index, "--count", 2)
    command("train", index, "real", "--model", "{kind: representation, grid: LR}")
    command("sample", "real", "reference", "--index", index, "--count", 2)
    certificate = rows_of(Path("samples/wls/certificate.csv"))
    assert [row["set"] for row in certificate] == 2 * ["generated"] + 6 * ["reconstructed"]
    few = "{points: 1000, volume_points: 1000, variety: {pairs: 4, closest: 2}}"
    command(
        *("evaluate", "samples/none/reconstructed", "reference/none/reconstructed"),
        *("--reconstructions", "samples/none/reconstructed", "--out", "report.json", "--options", few),
    )
    metrics = json.loads(Path("report.json").read_text())["found"]["metrics"]
    for name in ("chamfer", "variety", "mmd", "volume_iou"):
        assert metrics[name]["value"] > 0 and metrics[name]["n"] == 6
