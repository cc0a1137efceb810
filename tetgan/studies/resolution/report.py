"""Markdown table and figure of the resolution study."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tetgan.geometry.triangles import TriangleMesh
from tetgan.rendering.raycast import render_mesh
from tetgan.studies.options import ResolutionOptions
from tetgan.studies.resolution.representations import BINARY, BLOCKY, DEFORMED, DISTANCE, UNDEFORMED

_COLORS = {
    DEFORMED: "#d1601f",
    UNDEFORMED: "#2f6db3",
    BINARY: "#5c6570",
    BLOCKY: "#b0a04a",
    DISTANCE: "#4c9a6a",
}

_PIXELS = 360


def render_report(summary: pd.DataFrame, options: ResolutionOptions) -> str:
    """Markdown of the table that `summarise` made."""
    shown = pd.DataFrame(
        {
            "Representation": summary["representation"],
            "Resolution needed": summary["needed"],
            "Paper": summary["needed_paper"].map(lambda value: "—" if pd.isna(value) else f"{value}"),
            "Times the deformed": _times_deformed(summary["needed"].str.strip("<> ").astype(float)),
            "Paper's times": _times_deformed(summary["needed_paper"]),
            "Numbers stored": summary["numbers"],
            "Order": summary["order"].map("{:.2f}".format),
            "Finest measured": summary["finest"].map("{:.1f}".format),
            "Error there": summary["finest_error"].map("{:.1e}".format),
        }
    )
    table = shown.to_markdown(index=False, disable_numparse=True)
    return "\n\n".join(["# Resolution", _introduction(summary, options), table, _notes(options)]) + "\n"


def draw_report(
    path: Path, curves: pd.DataFrame, summary: pd.DataFrame, pictures: Mapping[str, TriangleMesh]
) -> None:
    """Pictures of the shapes, by title, above the error of each representation at every resolution."""
    figure = Figure(figsize=(13, 8), layout="constrained")
    upper, lower = np.asarray(figure.subfigures(2, 1, height_ratios=[1, 1.5]), dtype=object)
    for axes, (title, surface) in zip(upper.subplots(1, len(pictures)), pictures.items(), strict=True):
        size = (_PIXELS, _PIXELS)
        axes.imshow(render_mesh(surface.vertices, surface.faces, size=size, span=1.0, elevation=25))
        axes.set_title(title.replace(", ", "\n"), fontsize=10)
        axes.set_axis_off()
    _draw_curves(lower.subplots(), curves, summary)
    figure.savefig(path, dpi=130)


def _draw_curves(axes: Axes, curves: pd.DataFrame, summary: pd.DataFrame) -> None:
    target = summary["target"].iloc[0]
    axes.axhline(target, color="#999999", linewidth=1, linestyle=":")
    for row in summary.to_dict("records"):
        name, needed = row["representation"], row["needed"]
        color, curve = _COLORS[name], curves[curves["representation"] == name]
        label = f"{name}: needs {needed}³, order {row['order']:.1f}"
        axes.loglog(curve["resolution"], curve["error"], "o-", color=color, label=label, markersize=4)
        if not needed.startswith((">", "<")):
            axes.plot(float(needed), target, "o", color=color, markersize=10, fillstyle="none")
        if not pd.isna(row["needed_paper"]):
            axes.plot(row["needed_paper"], target, "x", color=color, markersize=9)
    axes.plot([], [], "x", color="black", label="the paper's resolutions: 41³, 161³, 301³")
    axes.set_xlabel("resolution: cube root of the number of tets or voxels")
    axes.set_ylabel("symmetric mean distance to the torus, cube sides")
    shown = curves["resolution"].min() / 1.3, curves["resolution"].max()
    ticks = [side for side in (4, 8, 16, 32, 64, 128, 256, 512) if shown[0] <= side <= shown[1]]
    axes.set_xticks(ticks, [str(side) for side in ticks])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)


def _times_deformed(resolutions: pd.Series) -> pd.Series:
    """Each over that of the deformed tets, which come first."""
    return (resolutions / resolutions.iloc[0]).map(
        lambda times: "—" if pd.isna(times) else f"{float(times):.1f}"
    )


def _introduction(summary: pd.DataFrame, options: ResolutionOptions) -> str:
    torus, target = options.torus, summary["target"].iloc[0]
    reference = str(summary.set_index("representation").loc[DEFORMED, "needed"])
    return (
        f"The resolution that each representation of one torus needs to reach the error {target:.2e} of "
        f"{reference}³ deformed tets (lattice of {options.reference_cells} cells, depth {options.depth}). "
        f"The torus is exact: radii {torus.major:g} and {torus.minor:g} of the side, about the middle, "
        f"axis {torus.axis}. The paper does not say which torus or which threshold it took, so its "
        "figures are beside ours and are no claim of equal conditions."
    )


def _notes(options: ResolutionOptions) -> str:
    notes = [
        "Resolution: cube root of the number of tets, or voxels along a side. It is interpolated between "
        "measurements on a log-log line; '> X': not reached at the finest, X.",
        f"Error: mean distance from {options.points:,} points uniform on the represented surface to the "
        "torus and mean distance from as many on the torus to the surface, averaged; not squared, in cube "
        "sides. Every one of these distances is exact.",
        "Undeformed tets: boundary of the tets whose centroid is inside. Deformed tets: the same boundary "
        "moved by Eq. 3 with the torus's own displacements, neither filtered nor smoothed.",
        "Binary voxels: inside or outside at voxel centres; the paper says both 'cubic voxels' (blocky: the "
        "boundary of the cubes inside) and 'extracted with marching cubes'. Distance voxels: the signed "
        "distance at the same places, which the paper leaves out.",
        "Numbers stored: one a tet or voxel, four a deformed tet (occupancy and displacement).",
        "Order: power of 1/resolution with which the error falls, fitted to all measurements.",
    ]
    return "\n".join(f"- {note}" for note in notes)
