"""Files of a model's smoothing study."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from tetgan.errors import UserError
from tetgan.evaluation.options import EvaluationOptions

SHAPES, REPORT, EXAMPLE = "shapes.csv", "report.json", "example.zip"
"""One row per shape and variant; options, FID and KID; the surfaces of one shape to look at, by name."""

REPAIRED = "repaired"
"""Name of the repaired shape among the variants of it."""


class Variant(NamedTuple):
    """A way from a field to a surface."""

    displaced: bool
    smoothing: str

    @property
    def name(self) -> str:
        return f"{'displaced' if self.displaced else 'blocky'}-{self.smoothing}"


VARIANTS = tuple(
    Variant(displaced, smoothing)
    for displaced in (False, True)
    for smoothing in ("none", "wls", "uniform", "cotangent")
)


class Study(NamedTuple):
    """Rows of every shape and variant, and the report beside them."""

    rows: pd.DataFrame
    report: Mapping[str, Any]

    @property
    def evaluation(self) -> EvaluationOptions:
        return EvaluationOptions.parse(self.report["evaluation"])

    def of(self, variant: Variant) -> pd.DataFrame:
        """The rows of one variant, by shape."""
        mine = (self.rows["smoothing"] == variant.smoothing) & (self.rows["displaced"] == variant.displaced)
        return self.rows[mine.astype(bool)].set_index("id")

    def of_repaired(self) -> pd.DataFrame:
        """Rows of the repaired shapes compared with themselves."""
        return self.rows[self.rows["smoothing"] == REPAIRED].set_index("id")


def read_study(folder: Path) -> Study:
    """Read what `measure_smoothing` wrote.

    Raises:
        UserError: it is missing or damaged.
    """
    kinds: dict[str, Any] = {"id": str, "smoothing": str, "displaced": "boolean"}
    try:
        rows = pd.read_csv(folder / SHAPES, dtype=kinds, keep_default_na=False, na_values=[""])
        return Study(rows, json.loads((folder / REPORT).read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise UserError(
            f"{folder}: not a smoothing study ({error}); run 'tetgan measure-smoothing' again"
        ) from None
