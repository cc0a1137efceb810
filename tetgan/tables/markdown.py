"""Tables in Markdown: cells, columns, pages; and a table written as CSV and as Markdown."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.files import check_suffix, whole_file


def write_twins(table: pd.DataFrame, text: str, out: Path) -> None:
    """Write the table as CSV, and its text beside it with the suffix `.md`.

    Raises:
        UserError: `out` is no `.csv`.
    """
    check_suffix(out, "a table", ".csv")
    with whole_file(out) as partial:
        table.to_csv(partial, index=False)
    with whole_file(out.with_suffix(".md")) as partial:
        partial.write_text(text, encoding="utf-8")


def page(title: str, *parts: str, notes: Sequence[str]) -> str:
    """A whole document: title, parts, and the notes as a list."""
    listed = "\n".join(f"- {note}" for note in notes)
    return "\n\n".join([f"# {title}", *parts, "## Notes", listed]) + "\n"


def markdown_table(columns: Mapping[str, Any]) -> str:
    """Columns of text, by title, as a table."""
    return pd.DataFrame(dict(columns)).to_markdown(index=False, disable_numparse=True)


def row_name(row: pd.Series) -> str:
    """The model, whether it was made a valid solid, and whether it was smoothed."""
    mode = ", solid" if row["mode"] == "solid" else ""
    smoothing = {"wls": ", wLS", "none": ", no wLS"}.get(row["smoothing"], "")
    return f"{row['model']}{mode}{smoothing}"


def metric_columns(table: pd.DataFrame, headings: Mapping[str, str]) -> dict[str, pd.Series]:
    """Cells of metrics by their heading, from a table that has their columns."""
    return {heading: table.apply(cell, axis=1, metric=name) for name, heading in headings.items()}


def cell(row: pd.Series, metric: str) -> str:
    """Value ± deviation [interval] (paper)."""
    value, std, low, high = (row[metric + part] for part in ("", "_std", "_low", "_high"))
    printed = row.get(f"{metric}_paper")
    paper = "" if pd.isna(printed) else f" (paper {printed})"
    if pd.isna(value):
        return f"—{paper}"
    deviation = "" if pd.isna(std) else f" ± {round_value(std)}"
    interval = "" if pd.isna(low) else f" [{round_value(low)}, {round_value(high)}]"
    return f"{round_value(value)}{deviation}{interval}{paper}"


def round_value(value: float) -> str:
    """Three digits that count, never in exponents that a column of figures would hide."""
    if abs(value) >= 1000:
        return f"{value:.0f}"
    return f"{value:.3g}" if abs(value) >= 1e-4 or value == 0 else f"{value:.1e}"


def plain(value: Any) -> str:
    """A value as it is, empty where there is none."""
    if pd.isna(value) or value == "":
        return ""
    return f"{value:g}" if isinstance(value, float) else str(value)
