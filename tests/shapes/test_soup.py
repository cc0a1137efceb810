"""Broken surfaces end with a reason before any library sees them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from soups import box, join

from tetgan.shapes.soup import ShapeError, Soup, clean_soup


def _with_vertex(value: float) -> Soup:
    soup = box()
    vertices = soup.vertices.copy()
    vertices[3, 1] = value
    return Soup(vertices, soup.faces)


_LINE = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])
_SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
BROKEN = {
    "no faces": Soup(box().vertices, np.zeros((0, 3), dtype=np.int64)),
    "no vertices": Soup(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)),
    "index too large": Soup(box().vertices, box().faces + 1),
    "index negative": Soup(box().vertices, box().faces - 1),
    "nan": _with_vertex(np.nan),
    "inf": _with_vertex(np.inf),
    "beyond float32": _with_vertex(1e300),
    "degenerate": Soup(box().vertices, np.repeat(np.arange(8)[:, None], 3, axis=1)),
    "one point": Soup(np.ones((8, 3)), box().faces),
    "collinear": Soup(_LINE, np.array([[0, 1, 2], [1, 2, 3], [2, 3, 4]])),
    "flat": Soup(_SQUARE, np.array([[0, 1, 2], [0, 2, 3]])),
}
REASONS = {
    "no faces": "no faces",
    "no vertices": "no faces",
    "index too large": "out of range",
    "index negative": "out of range",
    "nan": "not finite",
    "inf": "not finite",
    "beyond float32": "not finite",
    "degenerate": "no face with an area",
    "one point": "no face with an area",
    "collinear": "no face with an area",
    "flat": "flat",
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_shape_is_refused_with_its_reason(name: str) -> None:
    with pytest.raises(ShapeError, match=REASONS[name]):
        clean_soup(BROKEN[name])


def test_unused_vertices_and_degenerate_faces_go_and_the_rest_stays() -> None:
    soup = box()
    litter = Soup(
        np.concatenate([[[np.nan, 0, 0]], soup.vertices, [[9, 9, 9]]]),
        np.concatenate([[[1, 1, 2]], soup.faces + 1]),
    )
    clean = clean_soup(litter)
    np.testing.assert_array_equal(clean.triangles, soup.triangles)
    assert len(clean.vertices) == 8


@settings(deadline=None)
@given(
    scale=st.floats(1e-6, 1e6),
    shift=st.lists(st.floats(-10, 10), min_size=3, max_size=3),
    turn=st.floats(0, 6.28),
)
def test_what_is_refused_does_not_depend_on_place_or_size(
    scale: float, shift: list[float], turn: float
) -> None:
    rotation = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])

    def moved(soup: Soup) -> Soup:
        return Soup(scale * (soup.vertices @ rotation.T + shift), soup.faces)

    assert len(clean_soup(moved(box())).faces) == 12
    with pytest.raises(ShapeError):
        clean_soup(moved(BROKEN["flat"]))


def test_two_boxes_far_apart_are_a_shape() -> None:
    assert len(clean_soup(join(box(), box(centre=(100, 0, 0)))).faces) == 24
