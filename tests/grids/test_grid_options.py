"""Options of grids, good and bad."""

import pytest

from tetgan.errors import UserError
from tetgan.grids.hierarchy import build_hierarchy, grid_from_options
from tetgan.grids.lattice import cube_lattice
from tetgan.grids.options import GridOptions
from tetgan.grids.tetfile import write_tet


def test_cells_or_a_file_give_the_same_grid(tmp_path):
    write_tet(tmp_path / "base.tet", cube_lattice(2).grid)
    from_file = grid_from_options(GridOptions(file=tmp_path / "base.tet", depth=1))
    assert from_file.digest == grid_from_options(GridOptions(cells=2, depth=1)).digest
    assert from_file.digest == build_hierarchy(2, 1).digest


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ({"depth": 2}, "exactly one of 'cells' and 'file'"),
        ({"depth": 2, "cells": 2, "file": "a.tet"}, "exactly one of 'cells' and 'file'"),
        ({"depth": 2, "cell": 2}, "did you mean 'cells'?"),
        ({"depth": -1, "cells": 2}, "depth"),
        ({"cells": 2}, "depth"),
        ({"depth": 1, "cells": 0}, "cells"),
    ],
)
def test_bad_options_are_one_line(values, problem):
    with pytest.raises(UserError) as raised:
        GridOptions.parse(values, "grids.LR")
    assert problem in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_file_outside_the_cube_is_one_line(tmp_path):
    path = tmp_path / "far.tet"
    path.write_text("tet 4 1\n0 0 0\n9 0 0\n0 1 0\n0 0 1\n0 1 2 3\n")
    with pytest.raises(UserError, match=r"far\.tet: the grid reaches outside the unit cube; scale it to fit"):
        grid_from_options(GridOptions(file=path, depth=0))
