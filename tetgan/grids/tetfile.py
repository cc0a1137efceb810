"""QuarTet's text format for tet meshes.

First line `tet <vertices> <tets>`, then a line of three coordinates for each vertex, then a line of four
0-based indices for each tet.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.geometry.tets import tet_volumes
from tetgan.grids.grid import TetGrid


def read_tet(path: str | Path) -> TetGrid:
    """The grid in a `.tet` file; negative tets have their last two vertices exchanged.

    Raises:
        UserError: names the file and, where there is one, the line that is wrong.
    """
    try:
        lines = Path(path).read_text(encoding="ascii").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a text file"
        raise UserError(f"{path}: cannot read the grid: {reason}") from None
    vertex_count, tet_count = _counts(path, lines)
    body = vertex_count + 1
    if len(lines) < body + tet_count or any(map(str.strip, lines[body + tet_count :])):
        line = min(len(lines), body + tet_count) + 1
        raise UserError(
            f"{path}:{line}: the first line promises {vertex_count} vertices and {tet_count} tets"
        )
    vertices = _table(path, lines[1:body], 3, float, start=2)
    tets = _table(path, lines[body : body + tet_count], 4, int, start=body + 1)
    return TetGrid(vertices, _oriented(path, vertices, tets, start=body + 1))


def write_tet(path: str | Path, grid: TetGrid) -> None:
    """Write `grid` so that reading it back gives the same bits."""
    lines = [f"tet {len(grid.vertices)} {len(grid.tets)}"]
    for table in (grid.vertices, grid.tets):
        lines += [" ".join(map(repr, row)) for row in table.tolist()]
    with whole_file(path) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="ascii")


def _counts(path: str | Path, lines: list[str]) -> tuple[int, int]:
    match lines[0].split() if lines else []:
        case ["tet", vertices, tets] if vertices.isdigit() and tets.isdigit():
            return int(vertices), int(tets)
    raise UserError(f"{path}:1: expected 'tet <vertices> <tets>'")


def _table(path: str | Path, lines: list[str], columns: int, kind: type, start: int) -> np.ndarray:
    """Rows of `columns` finite numbers; `start` is the number of the first line in the file."""
    rows = np.zeros((len(lines), columns), dtype=np.float64 if kind is float else np.int64)
    for number, line in enumerate(lines):
        try:
            rows[number] = [kind(word) for word in line.split()]
        except (ValueError, OverflowError):
            pass
        else:
            if len(line.split()) == columns and np.isfinite(rows[number]).all():
                continue
        noun = "coordinates" if kind is float else "vertex indices"
        raise UserError(f"{path}:{start + number}: expected {columns} {noun}, found {line.strip()!r}")
    return rows


def _oriented(
    path: str | Path, vertices: Float[np.ndarray, "V 3"], tets: Int[np.ndarray, "T 4"], start: int
) -> Int[np.ndarray, "T 4"]:
    outside = ((tets < 0) | (tets >= len(vertices))).any(axis=1)
    if outside.any():
        number = int(outside.argmax())
        raise UserError(f"{path}:{start + number}: vertex index outside 0..{len(vertices) - 1}")
    volumes = tet_volumes(vertices, tets)
    if (volumes == 0).any():
        raise UserError(f"{path}:{start + int((volumes == 0).argmax())}: the tet has no volume")
    return np.where((volumes > 0)[:, None], tets, tets[:, [0, 1, 3, 2]])
