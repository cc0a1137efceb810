"""Captions that ship: one for every table and figure of the workflow, each filled in."""

import re
from pathlib import Path

import pytest
from jinja2 import StrictUndefined
from jinja2.sandbox import SandboxedEnvironment
from PIL import Image

from tetgan.config import TABLES
from tetgan.report import markup as captions
from tetgan.report.figures import read_figures
from tetgan.report.tables import read_tables

WORKFLOW = Path(__file__).parent.parent.parent / "workflow"
CONFIG = {"categories": ["chair", "vase"], "modes": ["paper", "solid"], "meshing": {"mode": "solid"}}
NAMES = re.compile(r'\bfigure\("([\w-]+)"')
"""Figures of a category; that of the resolution is everybody's."""


@pytest.fixture(autouse=True)
def nothing_is_missing(monkeypatch):
    """What a caption names and the page has not is an error here, and a gap elsewhere."""
    monkeypatch.setattr(captions, "_ENVIRONMENT", SandboxedEnvironment(undefined=StrictUndefined))


def test_every_table_has_its_own_caption(tmp_path):
    (tmp_path / "tables").mkdir()
    for name in (*TABLES, "chair"):
        (tmp_path / f"tables/{name}.csv").write_text("model\n")
    shown = {
        table.name: table.caption for table in read_tables(tmp_path, ["chair"], WORKFLOW / "report", CONFIG)
    }
    assert shown.keys() == {*TABLES, "chair"} and all(shown.values())
    assert shown["variety"].startswith("<p>variety of every category")
    assert "on chair:" in shown["ablation"] and "every model of chair" in shown["chair"]
    assert shown["simulation"].startswith("<p>Samples of each model, smoothed")


def test_every_figure_has_its_own_caption(tmp_path):
    rules = "\n".join(path.read_text() for path in (WORKFLOW / "rules").glob("*.smk"))
    names = {f"vase/{name}" for name in NAMES.findall(rules)} | {"resolution"}
    assert len(names) >= 12
    for name in names:
        (tmp_path / f"figures/{name}").parent.mkdir(parents=True, exist_ok=True)
        Image.new("RGB", (2, 2)).save(tmp_path / f"figures/{name}.png")
    shown = {one.path: one.caption for one in read_figures(tmp_path, ["vase"], WORKFLOW / "report", CONFIG)}
    assert len(shown) == len(names) and all(shown.values())
    assert "mode <code>solid</code>, smoothed" in shown["figures/vase/samples.png"]
    assert "mode <code>paper</code> where" in shown["figures/vase/comparison.png"]
    assert "A generated vase at rest" in shown["figures/vase/simulation.png"]
