"""The benchmarks: their form, the page made from them, and what a later run keeps."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture(autouse=True)
def _modules(monkeypatch):
    """They import each other by name, as scripts of one folder do."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))


def figure(value, **others):
    return {"value": value, "unit": "s", "target": None, "better": "lower", "device": "an abacus", **others}


def run(*arguments):
    command = [sys.executable, str(BENCHMARKS / "run.py"), "--quick", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_quick_run_writes_records_and_a_page(tmp_path):
    out, page = tmp_path / "latest.json", tmp_path / "docs" / "performance.md"
    page.parent.mkdir()
    page.write_text("# Speed\n\nBy hand.\n")
    result = run("--only", "grids", "--out", str(out), "--page", str(page), "--threads", "1")
    assert result.returncode == 0, result.stderr
    found = json.loads(out.read_text())
    assert found
    for name, each in found.items():
        assert list(each) == ["value", "unit", "target", "better", "device"], name
        assert isinstance(each["value"], float)
        assert each["value"] > 0
        assert each["target"] is None or isinstance(each["target"], float | int)
        assert each["better"] in ("higher", "lower")
        assert each["unit"]
        assert each["device"]
    assert page.read_text().startswith("# Speed\n\nBy hand.\n")
    assert "| grid, LR (73,728 tets) |" in page.read_text()
    assert (page.parent / "images" / "performance-tets.png").stat().st_size < 100_000


def test_an_unknown_benchmark_is_refused():
    from run import measure

    from tetgan.errors import UserError

    with pytest.raises(UserError, match="'speed' is not one of start, grids"):
        measure(("speed",), quick=True)


def test_every_benchmark_that_is_there_is_run():
    from run import MODULES

    made = {path.stem for path in BENCHMARKS.glob("*.py") if "\ndef run(quick: bool" in path.read_text()}
    assert made <= set(MODULES)


def test_a_target_is_met_from_its_own_side():
    from records import is_met

    assert is_met(figure(1.0, target=1.0)) is True
    assert is_met(figure(1.1, target=1.0)) is False
    assert is_met(figure(1.1, target=1.0, better="higher")) is True
    assert is_met(figure(0.9, target=1.0, better="higher")) is False
    assert is_met(figure(0.9)) is None


def test_figures_of_other_devices_outlive_a_run():
    from records import cpu_name
    from run import merge

    before = {"a": figure(1.0), "b": figure(2.0, device=cpu_name()), "c": figure(3.0)}
    found = {"c": figure(4.0, device=cpu_name())}
    assert merge(before, found, keep_all=False) == {"a": before["a"], "c": found["c"]}
    assert merge(before, found, keep_all=True) == {"a": before["a"], "b": before["b"], "c": found["c"]}


def test_points_of_a_curve_are_not_in_the_table():
    from performance import split_curves, table

    found = {
        "grid [tets=64]": figure(1.0),
        "grid [tets=8]": figure(20.0, unit="ms"),
        "grid": figure(3.0, target=2.0),
        "speedup [tets=8]": figure(4.0, unit="times", better="higher", target=3.0),  # no time: no curve
    }
    single, curves = split_curves(found)
    assert sorted(single) == ["grid", "speedup [tets=8]"]
    assert curves == {"tets": {"grid": [(64, found["grid [tets=64]"]), (8, found["grid [tets=8]"])]}}
    text = table(found | {"mesh": figure(7.0)})
    assert "| grid | 3 s | ≤ 2 s | **missed** |" in text
    assert "| speedup [tets=8] | 4 times | ≥ 3 times | met |" in text
    assert "64" not in text
    assert "mesh" not in text  # without a target


def test_the_page_keeps_what_people_wrote(tmp_path):
    from performance import BEGIN, END, write_page

    page = tmp_path / "performance.md"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    for value in (1.0, 2.0):
        write_page(page, {"grid": figure(value, target=1.0)}, [])
    text = page.read_text()
    assert text.startswith(f"before\n{BEGIN}\n")
    assert text.endswith(f"{END}\nafter\n")
    assert "old" not in text
    assert "| grid | 2 s | ≤ 1 s | **missed** |" in text
    assert "| grid | 1 s |" not in text


COSTS = """
from memory import iteration_cost
from tetgan.grids.hierarchy import build_hierarchy

grids = build_hierarchy(1, 1)
print(*(iteration_cost("LR", grids, "computed", 4, accumulate=each).gigabytes for each in (1, 3)))
"""


def test_a_batch_in_parts_takes_less_memory():
    # In a process of its own, without checks of types: tensors there have no content, and there are no draws.
    found = subprocess.run(
        [sys.executable, "-c", COSTS], cwd=BENCHMARKS, capture_output=True, text=True, check=True
    )
    whole, parts = map(float, found.stdout.split())
    # A third of the features, and all of the fields, weights and moments.
    assert whole / 3 < parts < whole / 2
