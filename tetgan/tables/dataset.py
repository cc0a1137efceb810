"""Stage: number of shapes per category: listed, repaired, rejected, split."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.errors import UserError
from tetgan.shapes.catalogue import read_catalogue
from tetgan.tables.markdown import markdown_table, page, plain, write_twins
from tetgan.tables.paper import quoted_figure, read_paper

CATEGORIES = ("chair", "sofa", "bench", "table", "car", "vase")
"""Those of the paper: each is a row, empty but for the paper's figure where it was not run."""

COUNTS = ("listed", "ok", "filled", "rejected", "train", "validation", "holdout")

_TITLES = {
    "listed": "Listed",
    "ok": "Repaired",
    "filled": "Repaired and filled",
    "rejected": "Rejected",
    "train": "Training",
    "validation": "Validation",
    "holdout": "Held out as surfaces",
    "reasons": "Why rejected",
}

_NOTES = [
    "Listed = repaired + repaired and filled + rejected. Training and validation count what was repaired, "
    "split 5 to 1 unless the source has a split of its own. Held-out surfaces are further shapes, for FID.",
    "The paper's sizes, in parentheses, are of ShapeNet and COSEG before the split.",
    "data/{category}/catalogue.csv has a row for every shape.",
]


def tabulate_dataset(catalogues: Sequence[Path], paper: Path, out: Path) -> None:
    """Write the table as CSV, and as Markdown beside it.

    Args:
        catalogues: `{category}/catalogue.csv`; the folder names the category.
        paper: published figures (`tetgan.tables.paper`).
        out: `.csv` to write.

    Raises:
        UserError: two catalogues of one category.
    """
    counts: dict[str, dict[str, Any]] = {}
    for path in catalogues:
        category = path.parent.name
        if category in counts:
            raise UserError(f"{path}: a second catalogue of '{category}'")
        counts[category] = count_shapes(read_catalogue(path))
    table = build_dataset(counts, read_paper(paper))
    write_twins(table, _render(table), out)


def count_shapes(catalogue: pd.DataFrame) -> dict[str, Any]:
    """`COUNTS` of one catalogue, and `reasons`: why shapes were rejected, each with its number."""
    status, split = catalogue["status"], catalogue["split"]
    repaired = status.isin(["ok", "filled"])
    reasons = Counter(catalogue.loc[status == "rejected", "reason"]).most_common()
    return {
        "listed": int((status != "surface").sum()),
        **{name: int((status == name).sum()) for name in ("ok", "filled", "rejected")},
        **{name: int((repaired & (split == name)).sum()) for name in ("train", "validation")},
        "holdout": int((status == "surface").sum()),
        "reasons": "; ".join(f"{number} {reason}" for reason, number in reasons),
    }


def build_dataset(counts: Mapping[str, Mapping[str, Any]], paper: pd.DataFrame) -> pd.DataFrame:
    """One row per category: the paper's in its order, then further ones."""
    rows = [
        {"category": category}
        | {name: counts.get(category, {}).get(name) for name in (*COUNTS, "reasons")}
        | {"listed_paper": quoted_figure(paper, category, "data set", "shapes")}
        for category in dict.fromkeys([*CATEGORIES, *counts])
    ]
    columns = ["category", "listed", "listed_paper", *COUNTS[1:], "reasons"]
    return pd.DataFrame(rows, columns=columns).astype(dict.fromkeys(COUNTS, "Int64"))


def _render(table: pd.DataFrame) -> str:
    columns = {"Category": table["category"]}
    columns |= {title: table[name].map(lambda value: plain(value) or "—") for name, title in _TITLES.items()}
    columns["Listed"] += table["listed_paper"].map(
        lambda value: "" if pd.isna(value) else f" (paper {value})"
    )
    columns["Why rejected"] = table["reasons"].map(plain)
    return page("Data set", markdown_table(columns), notes=_NOTES)
