"""Reading and writing QuarTet's `.tet` files."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.errors import UserError
from tetgan.geometry.tets import dihedral_angles
from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import build_hierarchy, subdivide_hierarchy
from tetgan.grids.tetfile import read_tet, write_tet

PAPERS_GRIDS = Path(__file__).parents[2] / ".." / "shared" / "grids"
ONE_TET = "tet 4 1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 2 3\n"


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_what_is_written_is_read(seed, tmp_path_factory):
    path = tmp_path_factory.mktemp("tet") / "grid.tet"
    base = build_hierarchy(1, 1).finest
    vertices = base.vertices + np.random.default_rng(seed).normal(scale=0.01, size=base.vertices.shape)
    write_tet(path, TetGrid(vertices, base.tets))
    assert read_tet(path).digest == TetGrid(vertices, base.tets).digest


def test_a_file_by_hand(tmp_path):
    path = tmp_path / "one.tet"
    path.write_text(ONE_TET + "\n")
    grid = read_tet(path)
    np.testing.assert_array_equal(grid.tets, [[0, 1, 2, 3]])
    np.testing.assert_array_equal(grid.vertices, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def test_a_negative_tet_is_turned(tmp_path):
    path = tmp_path / "one.tet"
    path.write_text(ONE_TET.replace("0 1 2 3", "1 0 2 3"))
    assert read_tet(path).volumes.min() > 0


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        ("", 1, "expected 'tet <vertices> <tets>'"),
        ("off 4 1\n", 1, "expected 'tet <vertices> <tets>'"),
        ("tet 4 -1\n", 1, "expected 'tet <vertices> <tets>'"),
        (ONE_TET.replace("1 0 0", "1 0"), 3, "expected 3 coordinates"),
        (ONE_TET.replace("1 0 0", "1 zero 0"), 3, "expected 3 coordinates, found '1 zero 0'"),
        (ONE_TET.replace("1 0 0", "1 nan 0"), 3, "expected 3 coordinates"),
        (ONE_TET.replace("1 0 0", "1 0 0 0"), 3, "expected 3 coordinates"),
        (ONE_TET.replace("1 0 0", "7"), 3, "expected 3 coordinates"),
        (ONE_TET.replace("0 1 2 3", "0 1 2.5 3"), 6, "expected 4 vertex indices"),
        (ONE_TET.replace("0 1 2 3", "0 1 2 4"), 6, "vertex index outside 0..3"),
        (ONE_TET.replace("0 1 2 3", "0 1 2 -1"), 6, "vertex index outside 0..3"),
        (ONE_TET.replace("0 1 2 3", "0 1 2 99999999999999999999"), 6, "expected 4 vertex indices"),
        (ONE_TET.replace("0 1 2 3", "0 1 2 2"), 6, "no volume"),
        (ONE_TET[:-8], 6, "promises 4 vertices and 1 tets"),
        (ONE_TET + "0 1 2 3\n", 7, "promises 4 vertices and 1 tets"),
    ],
)
def test_a_malformed_file_is_reported_by_line(tmp_path, text, line, problem):
    path = tmp_path / "bad.tet"
    path.write_text(text)
    with pytest.raises(UserError) as raised:
        read_tet(path)
    message = str(raised.value)
    assert message.startswith(f"{path}:{line}: ")
    assert problem in message
    assert "\n" not in message


def test_a_missing_and_a_binary_file_are_one_line(tmp_path):
    binary = tmp_path / "binary.tet"
    binary.write_bytes(bytes(range(256)))
    for path in (tmp_path / "absent.tet", binary, tmp_path):
        with pytest.raises(UserError, match=r"^[^\n]*cannot read the grid[^\n]*$"):
            read_tet(path)


@pytest.mark.skipif(not PAPERS_GRIDS.is_dir(), reason="the paper's grids are not at ../shared/grids")
@pytest.mark.parametrize(
    ("name", "vertices", "tets", "angles"),
    [
        ("cube_0.25.tet", 22, 42, None),
        # At depth 3 a fixed diagonal gives 15.8 to 153.4 degrees on this grid.
        ("cube_0.20.tet", 54, 134, (23.6, 138.4)),
        ("cube_0.15.tet", 140, 402, None),
    ],
)
def test_the_papers_own_grids(name, vertices, tets, angles):
    base = read_tet(PAPERS_GRIDS / name)
    assert (len(base.vertices), len(base.tets)) == (vertices, tets)
    finest = subdivide_hierarchy(base, 3).finest
    assert len(finest.tets) == tets * 512
    assert finest.volumes.min() > 0
    assert (finest.neighbors >= 0).sum(axis=1).min() >= 1
    if angles:
        dihedral = dihedral_angles(finest.vertices, finest.tets)
        assert (dihedral.min(), dihedral.max()) == pytest.approx(angles, abs=0.05)
