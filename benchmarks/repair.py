"""Both repair methods on the shapes of one source: rejects, faces, time, accuracy, and fields."""

import json
import resource
import time
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from jaxtyping import Bool, Float
from pydantic import TypeAdapter
from rich.console import Console
from rich.progress import track

from tetgan.geometry.inside import is_inside
from tetgan.geometry.rays import Visibility
from tetgan.geometry.triangles import TriangleMesh
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.shapes.cleaning import ShapeError, clean_mesh
from tetgan.shapes.entries import draw_entries
from tetgan.shapes.isolation import RepairWorker
from tetgan.shapes.normalise import normalise
from tetgan.shapes.options import RepairOptions, SourceOptions
from tetgan.shapes.repair import repair_shape, surface_distances
from tetgan.shapes.sources import list_shapes, load_shape

# Options of each row; the lengths are fractions of a shape's longest side.
VARIANTS: dict[str, dict[str, Any]] = {
    "manifold 5k": {"method": "manifold", "resolution": 5_000},
    "manifold 20k": {"method": "manifold", "resolution": 20_000},
    "alpha wrap 0.04 / 0.002": {"alpha": 0.04, "offset": 0.002},
    "alpha wrap 0.03 / 0.001": {"alpha": 0.03, "offset": 0.001},
    "alpha wrap 0.025 / 0.001": {"alpha": 0.025, "offset": 0.001},
    "alpha wrap 0.02 / 0.001": {"alpha": 0.02, "offset": 0.001},
}
MARGIN = 0.02


def main(
    *,
    source: Annotated[str, typer.Option(help="Source as in the config, JSON.")] = '{"kind": "builtin"}',
    category: Annotated[str, typer.Option(help="Category of the source.")] = "chair",
    count: Annotated[int, typer.Option(help="Shapes to draw.")] = 40,
    cells: Annotated[int, typer.Option(help="Cells of the grid that fields are compared on.")] = 2,
    depth: Annotated[int, typer.Option(help="Depth of that grid.")] = 3,
    variants: Annotated[list[str] | None, typer.Option(help=f"Of {', '.join(VARIANTS)}.")] = None,
    out: Annotated[Path | None, typer.Option(help="Write one row a shape and variant here, CSV.")] = None,
) -> None:
    """Compare repair methods; seconds are processor time on one core."""
    chosen: SourceOptions = TypeAdapter(SourceOptions).validate_python(json.loads(source))
    points = build_hierarchy(cells, depth).finest.centroids
    soups = _read_soups(chosen, category, count)
    truths = [seen_solid(soup, points) for soup in track(soups, "reference", console=Console(stderr=True))]
    rows = [row for name in variants or VARIANTS for row in measure(name, soups, truths, points)]
    table = pd.DataFrame(rows)
    if out is not None:
        table.to_csv(out, index=False)
    print(summarise(table).to_markdown(floatfmt=".4g"))


def _read_soups(source: SourceOptions, category: str, count: int) -> list[TriangleMesh]:
    entries = draw_entries(
        [entry for entry in list_shapes(source, category) if entry.split != "holdout"], count
    )
    soups = [clean_mesh(load_shape(source, category, entry)) for entry in entries]
    return [TriangleMesh(normalise(soup.vertices, MARGIN), soup.faces) for soup in soups]


def seen_solid(soup: TriangleMesh, points: Float[np.ndarray, "P 3"]) -> Bool[np.ndarray, "P"]:
    """Points inside the raw shape: none of 128 directions leads out. No face's orientation plays a part."""
    visibility = Visibility(soup.triangles)
    up = np.tile([0.0, 1.0, 0.0], (len(points), 1))
    return ~(visibility.sees_out_on_side(points, up, 64) | visibility.sees_out_on_side(points, -up, 64))


def measure(
    name: str,
    soups: list[TriangleMesh],
    truths: list[Bool[np.ndarray, "P"]],
    points: Float[np.ndarray, "P 3"],
) -> list[dict[str, Any]]:
    """One row a shape: what came back, what it cost, how far it is from the raw shape."""
    options = RepairOptions(**VARIANTS[name])
    rows: list[dict[str, Any]] = []
    before = _children_seconds()
    with RepairWorker(options) as worker:
        for soup, truth in track(list(zip(soups, truths, strict=True)), name, console=Console(stderr=True)):
            started = time.process_time()
            try:
                repaired = repair_shape(soup, worker, options)
            except ShapeError as error:
                rows.append({"variant": name, "reason": str(error)})
                continue
            seconds = time.process_time() - started
            # From the unit cube back into the frame of the raw shape, which repair offset outward.
            solid = TriangleMesh(
                (repaired.solid.vertices - 0.5) * (1 - 2 * MARGIN) + 0.5, repaired.solid.faces
            )
            field = is_inside(points, solid.vertices, solid.faces)
            distances = surface_distances(soup, solid)
            rows.append(
                {
                    "variant": name,
                    "reason": "",
                    "faces": len(solid.faces),
                    "filled": repaired.filled_share > 0,
                    "hollow": repaired.hollow,
                    "parent_seconds": seconds,
                    "distance": distances.mean(),
                    "distance_95": np.quantile(distances, 0.95),
                    "volume_ratio": field.sum() / max(truth.sum(), 1),
                    "field_iou": (field & truth).sum() / max((field | truth).sum(), 1),
                }
            )
    spent = _children_seconds() - before
    return [row | {"child_seconds": spent / len(soups)} for row in rows]


def _children_seconds() -> float:
    """Processor time of the children that have ended; a living one does not count yet."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def summarise(table: pd.DataFrame) -> pd.DataFrame:
    """One row a variant; medians over shapes, but means of times."""
    groups = table.groupby("variant", sort=False)
    summary = pd.DataFrame(
        {"shapes": groups.size(), "rejected": groups["reason"].agg(lambda x: (x != "").sum())}
    )
    summary["filled"] = groups["filled"].sum()
    summary["seconds"] = groups["child_seconds"].mean() + groups["parent_seconds"].mean()
    medians = groups[["faces", "distance", "distance_95", "volume_ratio", "field_iou"]].median()
    summary = summary.join(medians)
    summary["field_iou_mean"] = groups["field_iou"].mean()
    summary["reasons"] = groups["reason"].agg(
        lambda x: "; ".join(f"{n} {r}" for r, n in Counter(x).items() if r)
    )
    return summary


if __name__ == "__main__":
    typer.run(main)
