"""The command line: help with an example for every stage, and one clear line for every mistake."""

import subprocess
import sys

import pytest
from typer.testing import CliRunner

from tetgan.cli import app

COMMANDS = [
    command.name or command.callback.__name__.replace("_", "-") for command in app.registered_commands
]


def run(*arguments):
    return subprocess.run(
        [sys.executable, "-c", "from tetgan.cli import main; main()", *arguments],
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(command):
    result = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "200"})
    assert result.exit_code == 0
    assert f"tetgan {command}" in result.output


def test_help_imports_nothing_heavy():
    code = (
        "import sys; from tetgan.cli import app; from typer.testing import CliRunner;"
        "CliRunner().invoke(app, ['--help']);"
        "print([name for name in ('torch', 'trimesh', 'zarr', 'pandas', 'igl') if name in sys.modules])"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["extract-fields", "absent.zip", "out.zarr.zip", "--grid", "{cells: 1, depth: 1}"], ["absent.zip"]),
        (
            ["extract-fields", "absent.zip", "out.zarr.zip", "--grid", "{cels: 1, depth: 1}"],
            ["--grid", "cells"],
        ),
        (
            ["extract-fields", "absent.zip", "out.zarr.zip", "--grid", "absent.yaml"],
            ["--grid", "absent.yaml"],
        ),
        (["extract-fields", "absent.zip", "out.zarr.zip", "--grid", "{cells: ["], ["--grid", "YAML"]),
        (
            ["repair", "o.zip", "--category", "chair", "--source", "{kind: directory, path: absent}"],
            ["absent"],
        ),
        (["repair", "o.zip", "--category", "chair", "--source", "{kind: magic}"], ["--source", "magic"]),
        (
            [
                "index",
                "absent.zarr.zip",
                "o.json",
                "--catalogue",
                "absent.csv",
                "--grid",
                "{cells: 1, depth: 1}",
            ],
            ["absent"],
        ),
        (["index", "absent.zarr.zip", "o.json", "--catalogue", "absent.csv"], ["--grid", "--sampling"]),
        (
            [
                "index",
                "absent.zarr.zip",
                "o.json",
                "--catalogue",
                "absent.csv",
                "--sampling",
                "{kind: voxels, resolution: 32}",
            ],
            ["absent"],
        ),
        (["extract-samplings", "absent.zip", "out.zarr.zip", "--sampling", "{kind: points}"], ["absent.zip"]),
        (
            ["extract-samplings", "absent.zip", "out.zarr.zip", "--sampling", "{kind: rays}"],
            ["--sampling", "rays"],
        ),
        (["train", "absent.json", "model", "--model", "{kind: pca, grid: LR}"], ["absent.json"]),
        (["train", "absent.json", "model", "--model", "{kind: occnet}"], ["absent.json"]),
        (["simplify", "absent", "out"], ["absent", "no samples"]),
        (["sample", "absent", "out"], ["absent", "no folder", "chair"]),
        (["sample", "chair", "out", "--index", "absent.json"], ["absent.json"]),
        (["pack", "absent", "absent.json", "out"], ["absent.json"]),
        (["interpolate", "absent", "absent.json", "out"], ["absent.json"]),
        (["interpolate", "absent", "absent.json", "out", "--pair", "a"], ["--pair", "'a'", "2 ids"]),
        (["add-parts", "absent", "absent.json", "out", "--triple", "a:b"], ["--triple", "'a:b'", "3 ids"]),
        (["find-nearest", "absent.zip", "out.csv", "--catalogue", "absent.csv"], ["absent.csv"]),
        (["evaluate", "absent", "absent", "--out", "report.json"], ["absent", "no such folder"]),
        (["evaluate", "a", "b", "--out", "report.json", "--options", "{point: 3}"], ["point", "points"]),
        (["simulate", "absent.vtu"], ["error: absent.vtu: no such file"]),
        (["measure-resolution", "resolution.csv", "resolution.png"], ["resolution.csv", "another folder"]),
        (["sample", "chair", "out", "--mode", "smooth"], ["mode", "'paper'", "smooth"]),
    ],
)
def test_a_mistake_is_one_line_without_a_traceback(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.returncode == 2
    last = result.stderr.strip().splitlines()[-1]
    assert last.startswith("error: ")
    assert "Traceback" not in result.stderr
    for word in words:
        assert word in last
    assert list(tmp_path.iterdir()) == []
