"""Write figures to a table, to plots of cost against size, and into docs/performance.md."""

import re
from collections import defaultdict
from itertools import groupby
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from records import Record, Records, is_met

from tetgan.files import whole_file
from tetgan.rendering.plots import WIDTH, line_styles, plot_style

BEGIN, END = "<!-- made by `make bench`: do not edit -->", "<!-- end -->"
_POINT = re.compile(r"^(?P<curve>.+) \[(?P<size>[a-z]+)=(?P<at>\d+)\]$")
_SECONDS = {"s": 1.0, "CPU-s": 1.0, "ms": 1e-3, "CPU-ms": 1e-3}
_WIDE = 1000  # largest over smallest tick from which only powers of ten have labels
_DPI = 110  # a page wants pictures below 100 kB

Curves = dict[str, dict[str, list[tuple[int, Record]]]]
"""By the size they are drawn against, then by name: what was measured at each size."""


def split_curves(found: Records) -> tuple[Records, Curves]:
    """Single figures, and those that are points of a curve."""
    single: Records = {}
    curves: Curves = defaultdict(lambda: defaultdict(list))
    for name, each in found.items():
        match = _POINT.match(name)
        if match is None or each["unit"] not in _SECONDS:
            single[name] = each
        else:
            curves[match["size"]][match["curve"]].append((int(match["at"]), each))
    return single, curves


def table(found: Records) -> str:
    """Markdown: one table per device, of the figures that have a target and are no points of curves."""
    single = {name: each for name, each in split_curves(found)[0].items() if each["target"] is not None}
    parts = []
    rows = sorted(single.items(), key=lambda item: item[1]["device"])
    for device, group in groupby(rows, key=lambda item: item[1]["device"]):
        lines = [f"**{device}**", "", "| figure | value | target | |", "|---|---|---|---|"]
        parts.append("\n".join(lines + [_row(name, each) for name, each in group]))
    return "\n\n".join(parts) + "\n"


def _row(name: str, each: Record) -> str:
    value = f"{each['value']:.3g} {each['unit']}"
    sign = "≥" if each["better"] == "higher" else "≤"
    verdict = "met" if is_met(each) else "**missed**"
    return f"| {name} | {value} | {sign} {each['target']:g} {each['unit']} | {verdict} |"


def draw_figures(found: Records, folder: Path) -> list[Path]:
    """`performance-{size}.png`: seconds against each size, one line per curve, both scales logarithmic."""
    _, curves = split_curves(found)
    paths = []
    for size, lines in sorted(curves.items()):
        path = folder / f"performance-{size}.png"
        with whole_file(path) as partial, plot_style():
            _draw(size, lines).savefig(partial, dpi=_DPI, metadata={"Software": None})
        paths.append(path)
    return paths


def _draw(size: str, lines: dict[str, list[tuple[int, Record]]]) -> Figure:
    figure = Figure(figsize=(WIDTH, 2.6), layout="constrained")
    axes = figure.add_subplot()
    looks = line_styles(list(lines))
    for name, points in lines.items():
        sizes, records = zip(*sorted(points, key=lambda point: point[0]), strict=True)
        seconds = [each["value"] * _SECONDS[each["unit"]] for each in records]
        axes.plot(sizes, seconds, marker="o", label=name, **looks[name])
    axes.set(xscale="log", yscale="log", xlabel=size, ylabel="seconds", title=f"Cost against {size}")
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < _WIDE * low else (1,)))
        axis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:,.0f}")
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    figure.legend(loc="outside right upper")
    return figure


def write_page(page: Path, found: Records, pictures: list[Path]) -> None:
    """Put the table and the pictures between the two marks of the page; what people wrote around them stays.

    A page that is not there, or has no marks, gets them at its end.
    """
    text = page.read_text() if page.is_file() else "# Performance\n"
    if BEGIN not in text:
        text += f"\n{BEGIN}\n{END}\n"
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    shown = "\n".join(
        f"![Cost against {path.stem.rpartition('-')[2]}](images/{path.name})" for path in pictures
    )
    with whole_file(page) as partial:
        partial.write_text(f"{before}{BEGIN}\n\n{table(found)}\n{shown}\n\n{END}{after}")
