"""Made-up metrics of two categories, as files."""

import json
from pathlib import Path

import pandas as pd
import pytest
from clouds import clouds, extractor  # noqa: F401

PAPER = Path(__file__).parents[2] / "workflow" / "resources" / "paper_tables.csv"


@pytest.fixture
def paper() -> Path:
    return PAPER


@pytest.fixture
def report():
    """Makes the report of a model; a metric is (value, low, high, std, n), as far as it is known."""

    def make(
        category: str, model: str, seed: int = 0, *, notes=(), digest: str = "abc", method=None, **metrics
    ) -> dict:
        names = ("value", "low", "high", "std", "n")
        estimates = {
            name: dict.fromkeys(names) | dict(zip(names, values, strict=False))
            for name, values in metrics.items()
        }
        method = method or model.partition("-")[0]
        section = {
            "metrics": estimates,
            "generated": {"expected": 8, "found": 7},
            "notes": list(notes),
        }
        common = {
            "category": category,
            "model": model,
            "method": method,
            "options": {"bootstrap": {"level": 0.95}},
            "extractor": {"digest": digest, "accuracy": 0.9, "categories": ["bench", "vase"]},
        }
        if method == "real":
            return common | {"smoothings": {"none": section}}
        section["reconstructed"] = {"expected": 2, "found": 2}
        own = {"grid": model[-2:], "tets": 10, "mode": "paper", "seed": seed, "reduced": "depth 2 (paper 3)"}
        own["train_minutes"] = None if method == "representation" else 3.0
        return common | own | {"smoothings": {"none": section}}

    return make


@pytest.fixture
def write(tmp_path):
    """Writes reports to files."""

    def make(reports: list[dict]) -> list[Path]:
        paths = [tmp_path / f"{place}.json" for place in range(len(reports))]
        for path, each in zip(paths, reports, strict=True):
            path.write_text(json.dumps(each))
        return paths

    return make


@pytest.fixture
def read():
    """Reads a table as text, so that an empty cell is the empty string, and its readable twin."""

    def get(path: Path) -> tuple[pd.DataFrame, str]:
        table = pd.read_csv(path, dtype=str, keep_default_na=False)
        return table, path.with_suffix(".md").read_text()

    return get
