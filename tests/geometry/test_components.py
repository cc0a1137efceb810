"""Components against a flood fill, and tets joined across faces."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tetgan.geometry.components import connect_tets, label_components

NODES = st.integers(0, 11)


def flood(pairs: list[tuple[int, int]], count: int) -> list[int]:
    """Labels in the order of the first node of each component, by walking along the pairs."""
    labels = [-1] * count
    for start in range(count):
        if labels[start] >= 0:
            continue
        number, waiting = max(labels) + 1, [start]
        while waiting:
            node = waiting.pop()
            if labels[node] < 0:
                labels[node] = number
                waiting += [b for a, b in pairs if a == node] + [a for a, b in pairs if b == node]
    return labels


@given(st.lists(st.tuples(NODES, NODES)))
def test_labels_are_those_of_a_flood_fill(pairs):
    one, other = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    assert label_components(one, other, 12).tolist() == flood(pairs, 12)


def test_no_nodes_have_no_labels():
    nothing = np.empty(0, dtype=np.int64)
    assert label_components(nothing, nothing, 0).shape == (0,)


def test_tets_are_joined_by_faces_not_by_edges():
    # The first two share a face, the third only an edge of them.
    found = connect_tets(np.array([[0, 1, 2, 3], [1, 2, 3, 4], [0, 1, 5, 6]]))
    assert found.component.tolist() == [0, 0, 1]
    assert len(found.faces) == 3 + 3 + 4
    assert found.crowded_faces == 0


def test_a_face_of_three_tets_is_crowded_and_no_boundary():
    found = connect_tets(np.array([[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]))
    assert found.crowded_faces == 1
    assert len(found.faces) == 9
    assert found.component.tolist() == [0, 0, 0]


def test_two_tets_on_one_side_of_their_face_are_folded():
    # Both lie above the face 012; mirrored, the second lies below it.
    assert connect_tets(np.array([[0, 1, 2, 3], [0, 1, 2, 4]])).folded_faces == 1
    assert connect_tets(np.array([[0, 1, 2, 3], [1, 0, 2, 4]])).folded_faces == 0
