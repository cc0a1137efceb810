"""Which jobs an edit of a module makes again; and that a rule, its command and its function agree."""

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib.machinery import ModuleSpec
from pathlib import Path
from typing import NamedTuple

import pytest
from smoke_project import ROOT

from tetgan import code
from tetgan.cli import app
from tetgan.models.registry import find_method, loaded_methods

WORKFLOW = ROOT / "workflow"


class Rule(NamedTuple):
    """A rule's name, its command (none where it draws), and what it gives `code_digest`."""

    name: str
    command: str | None
    entry_points: tuple[str | Path, ...]
    of_model: bool


def read_rules() -> list[Rule]:
    """Every rule that has a digest of code, in all files; each that runs a command must have one."""
    return [rule for path in sorted(WORKFLOW.glob("rules/*.smk")) for rule in _rules_of(path.read_text())]


def _rules_of(text: str) -> list[Rule]:
    _, *parts = re.split(r"^ *(?:rule|use rule \w+ as) (\w+)(?::| with:)$", text, flags=re.MULTILINE)
    bodies = zip(parts[::2], parts[1::2], strict=True)
    return [_rule_of(name, body) for name, body in bodies if "code_digest(" in body or '"tetgan ' in body]


def _rule_of(name: str, body: str) -> Rule:
    (arguments,) = re.findall(r"code=code_digest\((.*?)\)", body, re.DOTALL)
    entries = re.findall(r'"([^"]+)"', arguments)
    command = re.search(r'"tetgan ([\w-]+) ', body)
    paths = tuple(WORKFLOW / "scripts" / entry if entry.endswith(".py") else entry for entry in entries)
    return Rule(name, command[1] if command else None, paths, "of_model=True" in arguments)


RULES = read_rules()
STAGES = [rule for rule in RULES if rule.command]
METHODS = sorted(method.name for method in loaded_methods() if method.trained)
COMMANDS = {command.callback.__name__.replace("_", "-") for command in app.registered_commands}


def entries_of(rule: Rule, method: str | None) -> list[str | Path]:
    names = [method, *find_method(method).of] if method else []
    return [*rule.entry_points, *(entry for name in names for entry in find_method(name).entry_points)]


JOBS = {
    f"{rule.name}/{method}" if method else rule.name: entries_of(rule, method)
    for rule in RULES
    for method in (METHODS if rule.of_model else [None])
}


@pytest.fixture(scope="module")
def package(tmp_path_factory) -> Path:
    """A copy of the package, to be edited."""
    folder = tmp_path_factory.mktemp("copy") / "tetgan"
    shutil.copytree(ROOT / "tetgan", folder, ignore=shutil.ignore_patterns("__pycache__", "pretrained"))
    return folder


@pytest.fixture(scope="module")
def changed(package) -> Iterator[Callable[[str], set[str]]]:
    """Jobs whose digest is another after an edit of a file."""
    spec = ModuleSpec("tetgan", None, origin=str(package / "__init__.py"), is_package=True)
    spec.submodule_search_locations = [str(package)]

    def digests() -> dict[str, str]:
        return {name: code.code_digest(*entries) for name, entries in JOBS.items()}

    def edit(name: str) -> set[str]:
        text = (package / name).read_text()
        (package / name).write_text(text + "\n# edited\n")
        after = digests()
        (package / name).write_text(text)
        return {name for name in JOBS if before[name] != after[name]}

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(code, "find_spec", lambda name: spec)
        before = digests()
        yield edit


def jobs(*rules: str) -> set[str]:
    """Jobs of rules; `x_` stands for every rule that begins so, `x/m` for one job of a model of a method."""
    found = set()
    for rule in rules:
        parts = {
            job
            for job in JOBS
            if rule in (job, job.partition("/")[0]) or (rule[-1] == "_" and job.startswith(rule))
        }
        assert parts, rule
        found |= parts
    return found


DATA = ("gather_catalogue", "repair_shapes", "sample_clouds", "extract_", "index_")
MESHED = ("sample_model", "interpolate_shapes", "add_parts")
FEW = ("train_model/occnet", "train_model/pca")


@pytest.mark.parametrize(
    ("edited", "again", "spared"),
    [
        ("geometry/adjacency.py", ("extract_fields", "sample_model", "evaluate_"), ("gather_catalogue",)),
        ("shapes/repair_worker.py", ("repair_shapes",), ("gather_", "sample_", "extract_", "train_")),
        ("shapes/builtin/chair.py", ("repair_shapes", "sample_clouds"), ("train_", "evaluate_", "tabulate_")),
        ("grids/hierarchy.py", ("extract_fields", "train_model/tetgan"), ("repair_shapes", "tabulate_")),
        ("fields/voxels.py", ("extract_samplings", "index_samplings"), ("extract_fields", "evaluate_")),
        ("nn/conv.py", ("train_model/tetgan", "sample_model/tetgan"), (*FEW, "extract_")),
        ("solids/certificate.py", ("sample_model", "simplify_samples"), (*DATA, "train_", "evaluate_")),
        ("meshing/build.py", (*MESHED, "measure_resolution"), (*DATA, *FEW, "evaluate_", "tabulate_")),
        ("rendering/sheet.py", ("draw_samples", "draw_smoothing"), ("evaluate_", "find_", "tabulate_")),
        ("models/sampling.py", MESHED, (*DATA, "evaluate_")),
        ("training/loop.py", ("train_model/occnet",), (*DATA, "sample_model/pca", "evaluate_")),
        ("extractor/network.py", ("train_extractor", "evaluate_"), ("train_model", "sample_", "tabulate_")),
        ("evaluation/chamfer.py", ("evaluate_", "find_"), (*DATA, "sample_model", "measure_resolution")),
        ("mechanics/solver.py", ("simulate_samples", "draw_simulation"), ("sample_model", "evaluate_")),
        ("mechanics/materials.py", ("simulate_samples", "draw_simulation"), ("tabulate_", "evaluate_")),
        ("studies/smoothing/smoothers.py", ("measure_smoothing",), ("tabulate_", "measure_resolution")),
    ],
)
def test_an_edit_reruns_what_needs_it(changed, edited, again, spared):
    found = changed(edited)
    assert not jobs(*again) - found
    assert not jobs(*spared) & found


@pytest.mark.parametrize(
    ("edited", "again"),
    [
        ("methods/occnet/network.py", ("train_model/occnet", "sample_model/occnet")),
        ("tables/quality.py", ("tabulate_quality",)),
        ("tables/supplement.py", ("tabulate_supplement",)),
        ("mechanics/table.py", ("tabulate_simulation",)),
        ("report/template/page.css", ("report_page",)),
        ("report/page.py", ("report_page",)),
        ("mechanics/remesh_worker.py", ("simulate_samples", "draw_simulation")),
        ("methods/tetgan/options.py", ()),
        ("cli/tables.py", ()),
    ],
)
def test_an_edit_reruns_nothing_else(changed, edited, again):
    studies = ("measure_smoothing/", "interpolate_shapes/", "add_parts/")  # take models of fields alone
    assert {job for job in changed(edited) if not job.startswith(studies)} == (
        jobs(*again) if again else set()
    )


def test_a_table_is_all_that_an_edited_table_reruns(changed):
    found = changed("tables/category.py")
    assert "tabulate_category" in found and all(job.startswith("tabulate_") for job in found)


@pytest.mark.parametrize("method", METHODS)
def test_an_edited_method_reruns_its_own_jobs_and_those_of_methods_on_top(changed, method):
    options = find_method(method).options.__module__
    found = changed(options.removeprefix("tetgan.").replace(".", "/").replace("options", "network.py"))
    above = {name for name in METHODS if method in find_method(name).of}
    assert {job.partition("/")[2] for job in found} == {method, *above}


# Loaded by options, which do not count, and by the registry, whose methods count for their own models alone.
BESIDE = {"tetgan.mechanics.materials", "tetgan.models.method", "tetgan.models.registry", "tetgan.errors"}

LOADED = """
import importlib, json, os, sys
import numpy, pandas, torch, trimesh, igl, zarr, meshio, matplotlib, scipy.stats, pydantic, skfem, jinja2
for entry in sys.argv[1:]:
    if os.fork() == 0:
        importlib.import_module(entry)
        names = [n for n, m in sys.modules.items() if n.startswith("tetgan.") and not hasattr(m, "__path__")]
        print(json.dumps([entry, names]), flush=True)
        os._exit(0)
    os.wait()
"""


def test_all_that_python_loads_for_a_stage_counts():
    entries = sorted({str(entry).partition(":")[0] for rule in STAGES for entry in rule.entry_points})
    run = subprocess.run([sys.executable, "-c", LOADED, *entries], capture_output=True, text=True, check=True)
    loaded = dict(map(json.loads, run.stdout.splitlines()))
    assert list(loaded) == entries
    for entry, names in loaded.items():
        counted = {name for name in names if not name.endswith(".options")} - BESIDE
        assert counted <= code.code_behind(entry).keys(), entry


@pytest.mark.parametrize("rule", STAGES, ids=lambda rule: rule.name)
def test_a_rule_its_command_and_its_function_bear_one_verb(rule):
    (entry,) = rule.entry_points
    module, _, function = str(entry).partition(":")
    assert rule.command in COMMANDS
    verbs = {rule.name.partition("_")[0], rule.command.partition("-")[0], function.partition("_")[0]}
    assert len(verbs) == 1
    assert f"\ndef {function}(" in (ROOT / module.replace(".", "/")).with_suffix(".py").read_text()
