"""Folders of results that differ in times alone are the same; any other difference is named."""

import importlib.util
import json
from pathlib import Path

import pytest

PATH = Path(__file__).parents[2] / "benchmarks" / "same_results.py"


@pytest.fixture
def same_results():
    spec = importlib.util.spec_from_file_location("same_results", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("name", "texts", "found"),
    [
        ("a.ply", ("1 2", "1 2"), []),
        ("a.ply", ("1 2", "1 3"), ["bytes"]),
        ("a.json", (json.dumps({"seconds": 1, "n": 2}), json.dumps({"seconds": 3, "n": 2})), []),
        ("a.json", (json.dumps({"n": [2, 3]}), json.dumps({"n": [2, 4]})), [".n[1]: 3 -> 4"]),
        ("a.json", (json.dumps({"n": 2}), json.dumps({"m": 2})), [".m added", ".n gone"]),
        ("a.csv", ("id,minutes\n0,1.5\n", "id,minutes\n0,2.5\n"), []),
        ("a.csv", ("id,fid\n0,1.5\n", "id,fid\n0,2.5\n"), ["row 0.fid: '1.5' -> '2.5'"]),
        ("a.csv", ("id\n0\n", "id\n0\n1\n"), ["1 rows -> 2"]),
    ],
)
def test_times_may_differ_and_nothing_else(same_results, tmp_path, name, texts, found):
    paths = [tmp_path / folder / name for folder in ("before", "after")]
    for path, text in zip(paths, texts, strict=True):
        path.parent.mkdir()
        path.write_text(text)
    assert same_results.differences(*paths) == found


def test_logs_and_checkpoints_are_not_compared(same_results, tmp_path):
    for name in ("logs/a.log", "models/checkpoint.pt", "tables/a.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert list(same_results.list_files(tmp_path)) == ["tables/a.csv"]
