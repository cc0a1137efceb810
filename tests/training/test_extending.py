"""The models of docs/extending.md: found, trained, resumed, sampled and measured like the built-in ones."""

import csv
import importlib
import json
import sys
from pathlib import Path

import pytest
import torch
import yaml
from typer.testing import CliRunner
from worked_example import CONFIG, CONFIG_ON_CODES, MODULE, ON_CODES, write_module

from tetgan.cli.app import app
from tetgan.config import Config, load_config, schema_text
from tetgan.errors import UserError
from tetgan.fields.store import FieldStore
from tetgan.meshing.options import MeshingOptions
from tetgan.models import registry
from tetgan.models.files import load_generator
from tetgan.models.registry import ModelOptions, find_method, load_plugins
from tetgan.models.samples import sample_model
from tetgan.models.sampling import decode_fields, draw_latents, encode_shapes, generate_fields
from tetgan.options import parse_options
from tetgan.training.learner import FieldLearner
from tetgan.training.run import train_model
from tetgan.training.sections import training_class

NAME = "my_models.linear"
DEFAULT = yaml.safe_load((Path(__file__).parents[2] / "config" / "config.yaml").read_text())
BRIEF = {"epochs": 6, "batch_size": 6, "device": "cpu"}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch) -> Path:
    """Holds the modules, is on the path, and is forgotten with all kinds that came of it."""
    write_module(tmp_path)
    write_module(tmp_path, ON_CODES, "codes")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(registry, "_loaded", dict(registry._loaded))
    yield tmp_path
    for name in [name for name in sys.modules if name.partition(".")[0] == "my_models"]:
        del sys.modules[name]


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
    take_step = FieldLearner.take_step

    def stop(self, rows, step, *others):
        if step == 7:  # within an epoch
            raise KeyboardInterrupt
        return take_step(self, rows, step, *others)

    monkeypatch.setattr(FieldLearner, "take_step", stop)
    with pytest.raises(KeyboardInterrupt):
        train(tiny_index, tmp_path / "stopped", checkpoint_seconds=0)
    monkeypatch.setattr(FieldLearner, "take_step", take_step)
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


TETGAN = {"kind": "tetgan", "grid": "LR", "width": 4, "code": 6, "training": {}}


@pytest.fixture(scope="module")
def shelf(tmp_path_factory) -> Path:
    """Keeps what `standing` trains."""
    return tmp_path_factory.mktemp("standing")


@pytest.fixture
def standing(tiny_index, shelf) -> Path:
    """Holds a TetGAN of a few steps, and one that draws its codes from a distribution that was learnt."""
    load_plugins(["my_models.codes"])
    if not (shelf / "codes").exists():
        few = {"epochs": 1, "batch_size": 8, "device": "cpu", "adversarial_start": 1, "picture_every": 1}
        train_any(tiny_index, shelf / "tetgan", TETGAN, few)
        codes, whole = {"kind": "codes", "grid": "LR", "of": "full"}, {"batch_size": 24, "device": "cpu"}
        many = whole | {"epochs": 600, "learning_rate": 0.01, "validate_every": 1000}
        train_any(tiny_index, shelf / "codes", codes, many, "tetgan")
    return shelf


def train_any(index: Path, out: Path, model: dict, training: dict, of: str | None = None) -> None:
    options = parse_options(ModelOptions, model, "model")
    under = None if of is None else out.parent / of
    train_model(index, options, training_class(options).parse(training), 0, out, of=under)


def test_a_model_on_top_of_another_learns_its_codes_and_leaves_it_as_it_was(tiny_index, standing):
    store = FieldStore.open(tiny_index)
    model, under = (load_generator(standing / name, store.hierarchy) for name in ("codes", "tetgan"))
    for name, value in under.state_dict().items():
        assert torch.equal(model.of.state_dict()[name], value)
    codes = encode_shapes(under, store, store.ids("train"), device="cpu")
    # Adam ends within steps of 0.01 of the optimum, where it is on all shapes at once.
    deviation = codes.std(dim=0, correction=0)
    assert ((model.mean - codes.mean(dim=0)) / deviation).abs().max() < 0.5
    assert (model.log_deviation.exp() / deviation).log().abs().max() < 0.5
    record = json.loads((standing / "codes" / "options.json").read_text())
    assert record["of"]["model"]["kind"] == "tetgan"
    rows = rows_of(standing / "codes" / "log.csv")
    assert float(rows[-1]["surprise"]) < float(rows[0]["surprise"])


def test_its_samples_are_the_other_s_decoding_of_its_own_draws(tiny_index, standing, tmp_path):
    store = FieldStore.open(tiny_index)
    model, under = (load_generator(standing / name, store.hierarchy) for name in ("codes", "tetgan"))
    latents = torch.cat(list(draw_latents(model, 4, seed=0, device="cpu")))
    normal = torch.cat(list(draw_latents(under, 4, seed=0, device="cpu")))
    torch.testing.assert_close(latents, model.mean + model.log_deviation.exp() * normal)
    expected = decode_fields(under, latents, store.max_displacement, device="cpu")
    for one, other in zip(generate_fields(model, store, 4, seed=0, device="cpu"), expected, strict=True):
        assert (one.occupancy == other.occupancy).all()
    sample_model(standing / "codes", tiny_index, tmp_path / "out", count=3, options=MeshingOptions(), seed=0)
    certificate = rows_of(tmp_path / "out" / "none" / "certificate.csv")
    assert [row["set"] for row in certificate] == 3 * ["generated"] + 6 * ["reconstructed"]


def test_a_model_may_stand_on_one_that_stands_on_a_third(tiny_index, standing, folder):
    text = ON_CODES.replace('Literal["codes"]', 'Literal["twice"]').replace('("tetgan",)', '("codes",)')
    write_module(folder, text, "twice")
    load_plugins(["my_models.twice"])
    train_any(tiny_index, standing / "twice", {"kind": "twice", "grid": "LR", "of": "codes"}, BRIEF, "codes")
    loaded = load_generator(standing / "twice", FieldStore.open(tiny_index).hierarchy)
    assert type(loaded.of.of) is type(
        load_generator(standing / "tetgan", FieldStore.open(tiny_index).hierarchy)
    )


def test_a_model_on_top_of_another_is_sized_by_its_own_kind_and_the_other_s():
    values = DEFAULT | CONFIG_ON_CODES | {"models": DEFAULT["models"] | CONFIG_ON_CODES["models"]}
    config = Config.parse(load_config(values))
    assert config.reductions("codes") == config.reductions("tetgan-LR")
    assert config.training_of("codes").learning_rate == 0.01
    values["models"] = values["models"] | {"codes": {"kind": "codes", "grid": "LR", "of": "pca-16"}}
    with pytest.raises(UserError, match=r"models.codes.of: 'pca-16' is no model of kind tetgan"):
        load_config(values)


def test_training_options_of_the_kind_have_a_section():
    values = laid_over_the_default()
    values["training"] = {"common": {"validate_every": 3}, "linear": {"learning_rate": 0.5, "epochs": 7}}
    training = Config.parse(load_config(values)).training_of("linear")
    assert (training.learning_rate, training.epochs, training.validate_every) == (0.5, 40, 3)
    values["training"] = {"linear": {"learning_rat": 0.5}}
    with pytest.raises(UserError, match=r"training.linear.learning_rat: unknown key; did you mean 'learning"):
        load_config(values)
