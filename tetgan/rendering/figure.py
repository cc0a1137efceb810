"""A figure: rows of shapes under one camera, with titles."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, UInt8
from rich.console import Console
from rich.progress import track

from tetgan.geometry.triangles import TriangleMesh
from tetgan.rendering.raycast import STEEL
from tetgan.rendering.sheet import Ink, contact_sheet, note
from tetgan.rendering.view import View

_PROPORTIONS = (0.6, 2.0)  # width of a cell over its height, at least and at most

EMPTY = "empty"
"""What the figure says where a model produced nothing."""


@dataclass(frozen=True, eq=False)
class Shape(TriangleMesh):
    """A surface in the unit cube, ready to draw: one colour (linear RGB), or one a face."""

    colors: Float[np.ndarray, "F 3"] | tuple[float, float, float] = STEEL


NOTHING = Shape(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
"""For a cell that stays white."""


@dataclass(frozen=True, eq=False)
class Row:
    """Shapes side by side.

    Attributes:
        title: text on the left.
        shapes: None where a model produced nothing; a row may be shorter than others.
        captions: text under each shape.
        azimuth: of the camera, if not the figure's own.
        ruled: whether a line separates this row from the one above.
    """

    title: str
    shapes: Sequence[Shape | None]
    captions: Sequence[str] = ()
    azimuth: float | int | None = None
    ruled: bool = False


def draw_rows(
    rows: Sequence[Row],
    view: View,
    column_titles: Sequence[str] | None = None,
    column_inks: Sequence[Ink] | None = None,
) -> UInt8[np.ndarray, "H W 3"]:
    """The sheet of all rows, at the largest scale at which every shape fits its cell.

    A cell is as large as the view's picture, but no wider than the shapes need.

    Raises:
        ValueError: no rows, or fewer column titles than columns.
    """
    columns = max((len(row.shapes) for row in rows), default=0)
    cells = [
        (row, own, column)
        for row, own in zip(rows, _common_scale(rows, view), strict=True)
        for column in range(columns)
    ]
    progress = track(cells, "drawing", console=Console(stderr=True), transient=True)
    return contact_sheet(
        [_draw(row, own, column) for row, own, column in progress],
        columns,
        titles=["".join(row.captions[column : column + 1]) for row, _, column in cells],
        row_titles=[row.title for row in rows],
        column_titles=column_titles,
        column_inks=column_inks,
        ruled_rows=[number for number, row in enumerate(rows) if row.ruled and (number or column_titles)],
    )


def _common_scale(rows: Sequence[Row], view: View) -> list[View]:
    """The view of each row: their directions differ, their scale and their shape do not."""
    turned = [view if row.azimuth is None else replace(view, azimuth=row.azimuth) for row in rows]
    reaches = [
        own.reach_of(shape.vertices for shape in row.shapes if shape is not None)
        for own, row in zip(turned, rows, strict=True)
    ]
    reach = np.max([np.zeros(2), *reaches], axis=0)
    return [replace(own, size=_cell_size(reach, view.size)).holding(reach) for own in turned]


def _cell_size(reach: Float[np.ndarray, "2"], size: tuple[int, int]) -> tuple[int, int]:
    """A cell of the height asked for, no wider than the shapes need."""
    if not reach.all():
        return size
    width = size[1] * float(np.clip(reach[0] / reach[1], *_PROPORTIONS))
    return min(size[0], round(width)), size[1]


def _draw(row: Row, view: View, column: int) -> UInt8[np.ndarray, "H W 3"]:
    if column >= len(row.shapes):
        return view.blank
    shape = row.shapes[column]
    if shape is None:
        return note(view.blank, EMPTY)
    return view.draw(shape.vertices, shape.faces, shape.colors)
