"""Table of the simulation study: one row per model and mode, over all its seeds."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from tetgan.errors import UserError
from tetgan.tables.markdown import markdown_table, page, round_value, write_twins

_IDENTITY = ["category", "model", "grid", "mode", "smoothing"]

_SPREAD = ["simulated", "standing", "displacement", "difference", "refined_difference"]

_NOTES = [
    "±: deviation over seeds of the same figure, of each seed's samples alone.",
    "Samples are the first generated ones of each model; of one in several pieces the largest is simulated.",
    "Not simulated: samples with inverted tets, for which no solution means anything; 'not held' are those"
    " whose feet do not keep them from moving; 'empty region' those without a face that looks down at the"
    " floor, or up at the top; 'nothing in it' are empty ones.",
    "Standing: the centre of mass lies above the hull of the feet.",
    "Largest displacement: median over the simulated samples, with the 5th and 95th percentiles, mm.",
    "Remeshed: the surface of the first of them was filled anew by fTetWild, and the same load put on it. The"
    " difference is that of the largest displacement, as a share of the remeshed body's, whatever its sign;"
    " then once more with the sample's own tets cut into eight, which leaves the shape as it is.",
]


def tabulate_simulation(studies: Sequence[Path], out: Path) -> None:
    """Write a row for each model and mode, as CSV and as Markdown.

    Args:
        studies: one for each model, mode and seed.

    Raises:
        UserError: a file is no study of `tetgan simulate-samples`.
    """
    seeds: dict[tuple[str, ...], list[pd.DataFrame]] = {}
    for rows in map(_read, studies):
        seeds.setdefault(tuple(map(str, _identity(rows).values())), []).append(rows)
    table = pd.DataFrame(list(map(over_seeds, seeds.values())))
    write_twins(table, page("Simulation", _readable(table), notes=_NOTES), out)


def over_seeds(studies: Sequence[pd.DataFrame]) -> dict[str, Any]:
    """Figures of `summarise` over the samples of all seeds, and their deviation from seed to seed."""
    of_each = pd.DataFrame([summarise(rows) for rows in studies])
    spread = of_each[_SPREAD].astype(float).std(ddof=1)
    return {
        **_identity(studies[0]),
        "seeds": len(studies),
        **summarise(pd.concat(studies, ignore_index=True)),
        **{f"{name}_std": spread[name] for name in _SPREAD},
    }


def _identity(rows: pd.DataFrame) -> dict[str, Any]:
    return {name: rows[name].iloc[0] for name in _IDENTITY if name in rows}


def summarise(rows: pd.DataFrame) -> dict[str, Any]:
    """Counts, and the distribution of what was measured, over samples."""
    done = rows[rows["reason"] == ""]
    failed = rows.loc[rows["reason"] != "", "reason"].value_counts()
    peaks = 1e3 * _column(done, "peak_displacement")
    difference, refined = (
        _column(done, name).abs().dropna() for name in ("difference", "refined_difference")
    )
    return {
        "n": len(rows),
        "simulated": len(done),
        "failed": len(rows) - len(done),
        "reasons": "; ".join(f"{count} {reason}" for reason, count in failed.items()),
        "in_pieces": int((_column(done, "pieces") > 1).sum()),
        "standing": int((_column(done, "standing") == 1).sum()),
        "tets": _column(done, "tets").median(),
        "seconds": _column(done, "seconds").median(),
        "seconds_most": _column(done, "seconds").max(),
        "imbalance_most": _column(done, "imbalance").max(),
        "displacement": peaks.median(),
        "displacement_p5": peaks.quantile(0.05),
        "displacement_p95": peaks.quantile(0.95),
        "stress_p99": _column(done, "stress_p99").median() / 1e6,
        "remeshed": len(difference),
        "remeshed_tets": _column(done, "remeshed_tets").median(),
        "difference": difference.median(),
        "difference_p90": difference.quantile(0.9),
        "difference_most": difference.max(),
        "refined_difference": refined.median(),
        "refined_difference_most": refined.max(),
    }


def _column(rows: pd.DataFrame, name: str) -> pd.Series:
    """Numbers of a column; missing ones where no row has it."""
    values = rows[name] if name in rows else pd.Series(float("nan"), rows.index)
    return values.astype(float)


def _read(path: Path) -> pd.DataFrame:
    kinds = {"id": str, "reason": str, "smoothing": str}
    try:
        rows = pd.read_csv(path, dtype=kinds, keep_default_na=False, na_values=[""])
        return rows.assign(reason=rows["reason"].fillna(""))
    except (OSError, ValueError, KeyError) as error:
        raise UserError(f"{path}: not a simulation study ({error}); run 'tetgan simulation-study'") from None


def _readable(table: pd.DataFrame) -> str:
    return markdown_table(
        {
            "Category": table["category"],
            "Model": table["model"],
            "Mode": table["mode"],
            "Samples": table["n"],
            "Simulated": table.apply(_with_spread, axis=1, args=("simulated", str)),
            "Not simulated": table["reasons"].replace("", "—"),
            "In pieces": table["in_pieces"],
            "Standing": table.apply(_with_spread, axis=1, args=("standing", str)),
            "Tets": table["tets"].map(_number),
            "Seconds": table["seconds"].map(_number),
            "Largest displacement, mm": table.apply(_peaks, axis=1),
            "Remeshed": table["remeshed"],
            "Difference, median (largest)": table.apply(_differences, axis=1, args=("difference",)),
            "With each tet cut into eight": table.apply(_differences, axis=1, args=("refined_difference",)),
        }
    )


def _peaks(row: pd.Series) -> str:
    low, high = (_number(row[f"displacement{end}"]) for end in ("_p5", "_p95"))
    return f"{_with_spread(row, 'displacement', _number)} [{low}, {high}]"


def _differences(row: pd.Series, name: str) -> str:
    if not row["remeshed"]:
        return "—"
    return f"{_with_spread(row, name, _share)} ({_share(row[f'{name}_most'])})"


def _with_spread(row: pd.Series, name: str, show: Callable[[Any], str]) -> str:
    """A figure, and its deviation over seeds where there are several."""
    spread = row[f"{name}_std"]
    return show(row[name]) + (
        "" if pd.isna(spread) else f" ± {_share(spread) if show is _share else _number(spread)}"
    )


def _number(value: float) -> str:
    return "—" if pd.isna(value) else round_value(value)


def _share(value: float) -> str:
    return "—" if pd.isna(value) else f"{value:.1%}"
