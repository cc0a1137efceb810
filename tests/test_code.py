"""The digest of code changes with the modules that a stage imports, and with nothing else."""

import sys
from pathlib import Path

import pytest

import tetgan.nn.backends
from tetgan.code import _imported, code_digest
from tetgan.models.registry import find_method

FILES = {
    "__init__.py": "",
    "entry.py": "import json\nfrom invented.near import thing\n",
    "near.py": "def thing():\n    from . import far\n    return far\n",
    "far.py": "import numpy\n",
    "apart.py": "",
}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """`entry` imports `near`, which imports `far` within a function; nothing imports `apart`."""
    folder = tmp_path / "invented"
    folder.mkdir()
    for name, text in FILES.items():
        (folder / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    return folder


def test_what_is_imported_counts_and_nothing_is_executed(package):
    found = _imported(["invented.entry"], set())
    assert set(found) == {"invented", "invented.entry", "invented.near", "invented.far"}
    assert "invented" not in sys.modules


@pytest.mark.parametrize(
    ("name", "counts"), [("entry.py", True), ("near.py", True), ("far.py", True), ("apart.py", False)]
)
def test_an_edit_counts_where_the_module_is_imported(package, name, counts):
    before = code_digest(["invented.entry"], ())
    assert code_digest(["invented.entry"], ()) == before
    (package / name).write_text(FILES[name] + "# edited\n")
    assert (code_digest(["invented.entry"], ()) != before) == counts


def test_a_single_module_and_one_that_is_not_there(tmp_path, monkeypatch):
    (tmp_path / "alone_here.py").write_text("import absent_here\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert set(_imported(["alone_here", "absent_here.part"], set())) == {"alone_here"}


def test_modules_that_are_named_in_part_all_count(package):
    (package / "entry.py").write_text(
        "import importlib\ndef one(name):\n    importlib.import_module(f'invented.{name}')\n"
    )
    assert {"invented.near", "invented.far", "invented.apart"} <= set(_imported(["invented.entry"], set()))


def test_every_backend_of_the_convolution_counts():
    backends = {path.stem for path in (Path(tetgan.nn.backends.__file__).parent).glob("*.py")} - {"__init__"}
    assert {f"tetgan.nn.backends.{name}" for name in backends} <= behind("tetgan")


def behind(kind: str) -> set[str]:
    modules = ["tetgan.training.run", *find_method(kind).modules]
    return set(_imported(modules, {"nn", "models", "training", "methods"}))


def test_kinds_of_this_package_do_not_depend_on_each_other():
    tetgan, occnet, pca = map(behind, ("tetgan", "occnet", "pca"))
    assert {"tetgan.methods.tetgan.network", "tetgan.methods.tetgan.learner", "tetgan.nn.conv"} <= tetgan
    assert {"tetgan.methods.occnet.network", "tetgan.methods.occnet.training"} <= occnet
    assert not any("occnet" in name or "shapegan" in name or "deftet" in name for name in tetgan | pca)
    assert not any(
        "tetgan.methods.tetgan.network" in name or "tetgan.nn.conv" in name for name in occnet | pca
    )
    assert {"tetgan.models.files", "tetgan.training.run"} <= tetgan & occnet & pca


def test_what_reaches_a_stage_as_its_parameters_does_not_count():
    assert not any(name.endswith("options") or name.endswith("builtin") for name in behind("tetgan"))
