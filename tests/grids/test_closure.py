"""Green patterns: which there are, that their pieces fill the tet, and the angles they leave."""

from itertools import permutations

import numpy as np
import pytest

from tetgan.geometry.adjacency import EDGES, FACES
from tetgan.geometry.tets import dihedral_angles, tet_volumes
from tetgan.grids.closure import PIECES, edge_pattern, pattern_edges
from tetgan.grids.lattice import cube_lattice
from tetgan.grids.subdivision import CHILDREN

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])

# Least dihedral angle in degrees of a tet and of its pieces, by the squares of its edges in units of half a
# cell. The first shape fills all but the half cells at the wall; the second is its half, whose children have
# the others.
LEAST_ANGLES = {
    # edges: whole, one edge or two opposite ones split, three edges split
    (3, 3, 3, 3, 4, 4): (60.0, 30.0, 47.869586),
    (1, 2, 2, 3, 3, 4): (45.0, 18.434949, 33.557310),
    (1, 2, 2, 3, 3, 5): (48.189685, 19.471221, 29.205932),
    (1, 2, 2, 3, 4, 5): (35.264390, 15.793169, 24.094843),
    (1, 2, 3, 3, 4, 5): (30.0, 13.897886, 19.471221),
    (2, 2, 3, 3, 4, 5): (30.0, 13.897886, 20.229542),
}


def with_midpoints(corners):
    """In units half as large."""
    return np.concatenate([2 * corners, corners[EDGES].sum(axis=1)])


def diagonals(corners):
    """Squared lengths of the three."""
    midpoints = corners[EDGES].sum(axis=1)
    return ((midpoints[:3] - midpoints[:2:-1]) ** 2).sum(axis=1)


def shape(corners):
    """Squares of the edges, the same for congruent tets and for no others."""
    squares = ((corners[:, None] - corners) ** 2).sum(axis=2)
    return min(tuple(squares[np.ix_(turn, turn)][*EDGES.T].tolist()) for turn in permutations(range(4)))


@pytest.fixture(scope="module")
def shapes():
    """One tet of each shape that the lattice has at any depth: whichever of its shortest diagonals splits a
    tet, the shapes of its children are among them.
    """
    lattice = cube_lattice(2)
    found = {}
    todo = list(lattice.points[lattice.tets])
    while todo:
        corners = todo.pop()
        if found.setdefault(shape(corners), corners) is corners:
            lengths = diagonals(corners)
            for children in CHILDREN[lengths == lengths.min()]:
                todo += list(with_midpoints(corners)[children])
    return list(found.values())


def test_split_edges_join_corners_in_groups():
    # Partitions of four corners: 1 whole, 6 with a pair, 3 with two, 4 with three; and all four together.
    assert [sum(len(pieces) == count for pieces in PIECES.values()) for count in (1, 2, 4)] == [1, 6, 7]
    for pattern in [*PIECES, 63]:
        split = pattern_edges(np.array([pattern]))
        assert edge_pattern(split)[0] == pattern
        for face in FACES:
            on_face = np.isin(EDGES, face).all(axis=1)
            assert split[0, on_face].sum() in (0, 1, 3)


def test_closing_adds_what_it_must():
    for bits in range(64):
        split = pattern_edges(np.array([bits]))
        closed = pattern_edges(edge_pattern(split))
        assert (closed >= split).all()
        # No smaller pattern would do.
        holding = [other for other in [*PIECES, 63] if other & bits == bits]
        assert closed.sum() == min(other.bit_count() for other in holding)


@pytest.mark.parametrize("pattern", PIECES)
def test_pieces_fill_the_tet_and_split_what_the_pattern_says(pattern):
    local = with_midpoints(CORNERS)
    pieces = PIECES[pattern]
    volumes = tet_volumes(local.astype(float), pieces)
    np.testing.assert_allclose(volumes, 8 / 6 / len(pieces), rtol=1e-12)
    assert set(pieces.ravel()) == {*range(4), *(4 + np.flatnonzero(pattern_edges(np.array([pattern]))[0]))}


def test_least_angles_of_all_pieces(shapes):
    angles = {}
    for corners in shapes:
        local = with_midpoints(corners).astype(float)
        least = dict.fromkeys(range(4), 180.0)
        for pattern, pieces in PIECES.items():
            count = pattern.bit_count()
            least[count] = min(least[count], dihedral_angles(local, pieces).min())
        assert least[1] == pytest.approx(least[2])
        angles[tuple(sorted(shape(corners)))] = (least[0], least[1], least[3])
    assert angles.keys() == LEAST_ANGLES.keys()
    assert len(shapes) == len(angles)
    assert np.sqrt(np.max([*LEAST_ANGLES])) == cube_lattice(2).longest_edge
    for edges, expected in LEAST_ANGLES.items():
        assert angles[edges] == pytest.approx(expected, abs=1e-6)
