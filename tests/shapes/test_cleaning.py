"""Broken surfaces end with a reason before any library sees them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from soups import box, join

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import ShapeError, clean_mesh


def _with_vertex(value: float) -> TriangleMesh:
    soup = box()
    vertices = soup.vertices.copy()
    vertices[3, 1] = value
    return TriangleMesh(vertices, soup.faces)


_LINE = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])
_SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
BROKEN = {
    "no faces": TriangleMesh(box().vertices, np.zeros((0, 3), dtype=np.int64)),
    "no vertices": TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)),
    "index too large": TriangleMesh(box().vertices, box().faces + 1),
    "index negative": TriangleMesh(box().vertices, box().faces - 1),
    "nan": _with_vertex(np.nan),
    "inf": _with_vertex(np.inf),
    "beyond float32": _with_vertex(1e300),
    "degenerate": TriangleMesh(box().vertices, np.repeat(np.arange(8)[:, None], 3, axis=1)),
    "one point": TriangleMesh(np.ones((8, 3)), box().faces),
    "collinear": TriangleMesh(_LINE, np.array([[0, 1, 2], [1, 2, 3], [2, 3, 4]])),
    "flat": TriangleMesh(_SQUARE, np.array([[0, 1, 2], [0, 2, 3]])),
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
        clean_mesh(BROKEN[name])


def test_unused_vertices_and_degenerate_faces_go_and_the_rest_stays() -> None:
    soup = box()
    litter = TriangleMesh(
        np.concatenate([[[np.nan, 0, 0]], soup.vertices, [[9, 9, 9]]]),
        np.concatenate([[[1, 1, 2]], soup.faces + 1]),
    )
    clean = clean_mesh(litter)
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

    def moved(soup: TriangleMesh) -> TriangleMesh:
        return TriangleMesh(scale * (soup.vertices @ rotation.T + shift), soup.faces)

    assert len(clean_mesh(moved(box())).faces) == 12
    with pytest.raises(ShapeError):
        clean_mesh(moved(BROKEN["flat"]))


def test_two_boxes_far_apart_are_a_shape() -> None:
    assert len(clean_mesh(join(box(), box(centre=(100, 0, 0)))).faces) == 24
