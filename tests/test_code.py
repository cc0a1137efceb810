"""The digest of code changes with what a module imports, and with nothing else."""

import sys

import pytest

import tetgan.code
from tetgan.code import code_behind, code_digest

FILES = {
    "__init__.py": "",
    "entry.py": "import json\nfrom invented.near import thing\nCHILD = 'invented.child'\n",
    "near.py": "def thing():\n    from . import far\n    return far\n",
    "far.py": "import numpy\n",
    "child.py": "",
    "apart.py": "NAME = 'invented.entry is not apart'\n",
    "pages/page.html": "<html>",
}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """`entry` imports `near`, which imports `far` in a function, and names `child`; nothing needs `apart`."""
    folder = tmp_path / "invented"
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    return folder


def test_what_is_imported_counts_and_nothing_is_executed(package):
    names = {"invented", *(f"invented.{name}" for name in ("entry", "near", "far", "child"))}
    assert code_behind("invented.entry:main").keys() == names
    assert "invented" not in sys.modules


@pytest.mark.parametrize(
    ("name", "counts"),
    [
        ("__init__.py", True),
        ("entry.py", True),
        ("near.py", True),
        ("far.py", True),
        ("child.py", True),
        ("apart.py", False),
        ("pages/page.html", False),
    ],
)
def test_an_edit_counts_where_the_module_is_needed(package, name, counts):
    before = code_digest("invented.entry")
    assert code_digest("invented.entry") == before
    (package / name).write_text(FILES[name] + "# edited\n")
    assert (code_digest("invented.entry") != before) == counts


def test_another_function_of_the_same_module_is_another_entry_point(package):
    assert code_digest("invented.entry:one") != code_digest("invented.entry:two")
    assert code_digest("invented.near", "invented.far") == code_digest("invented.far", "invented.near")


def test_data_beside_a_module_that_names_their_folder_count(package):
    (package / "entry.py").write_text("FOLDER = 'pages'\n")
    before = code_digest("invented.entry")
    assert "invented/pages/page.html" in code_behind("invented.entry")
    (package / "pages" / "page.html").write_text("<p>")
    assert code_digest("invented.entry") != before


def test_a_script_counts_wherever_it_lies(package, tmp_path):
    digests = set()
    for folder in ("here", "there"):
        (tmp_path / folder).mkdir()
        script = tmp_path / folder / "draw.py"
        script.write_text("from tetgan.rendering.view import View\n")
        digests.add(code_digest(script))
    assert len(digests) == 1
    assert "tetgan.rendering.view" in code_behind(script)
    script.write_text("from tetgan.rendering.view import View as Eye\n")
    assert code_digest(script) not in digests


def test_a_single_module_and_one_that_is_not_there(tmp_path, monkeypatch):
    (tmp_path / "alone_here.py").write_text("import absent_here\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert set(code_behind("alone_here", "absent_here.part")) == {"alone_here"}


def test_modules_that_are_named_in_part_all_count(package):
    (package / "entry.py").write_text(
        "import importlib\ndef one(name):\n    importlib.import_module(f'invented.{name}')\n"
    )
    assert {"invented.near", "invented.far", "invented.apart"} <= code_behind("invented.entry").keys()


def test_every_backend_of_the_convolution_counts():
    folder = tetgan.code._path_of("tetgan.nn.backends").parent
    backends = {f"tetgan.nn.backends.{path.stem}" for path in folder.glob("*.py")} - {
        "tetgan.nn.backends.__init__"
    }
    assert len(backends) > 3 and backends <= code_behind("tetgan.nn.conv").keys()


def test_options_do_not_count_nor_what_they_alone_import():
    behind = code_behind("tetgan.mechanics.options", "tetgan.methods.tetgan.training")
    assert "tetgan.methods.tetgan.training" in behind
    assert not any(name.endswith("options") or name == "tetgan.mechanics.materials" for name in behind)
