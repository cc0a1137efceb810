"""Surfaces that need no repair, and those that do."""

import numpy as np
import pytest
from soups import box, join, without_side

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.closing import close_surface, count_pieces, join_vertices, turn_outward
from tetgan.shapes.options import RepairOptions

COARSE = RepairOptions(alpha=0.1, offset=0.002)


def turned(soup):
    return TriangleMesh(soup.vertices, soup.faces[:, ::-1])


def apart(soup):
    """Every face with corners of its own, as in an .stl."""
    return TriangleMesh(soup.triangles.reshape(-1, 3), np.arange(soup.faces.size).reshape(-1, 3))


def test_a_closed_box_is_left_alone():
    closed = close_surface(box((1, 2, 3), (50, 0, 0)), "auto", COARSE)
    assert (closed.repair, closed.reason) == ("none", "")
    assert closed.surface.volume == pytest.approx(6, rel=1e-12)


def test_faces_with_corners_of_their_own_are_joined():
    joined = join_vertices(apart(box()))
    assert len(joined.vertices) == 8
    assert close_surface(apart(box()), "auto", COARSE).repair == "none"


@pytest.mark.parametrize("rows", [slice(None), [0, 3, 7]], ids=["all faces", "some"])
def test_faces_that_point_inward_are_turned(rows):
    soup = box((1, 2, 3))
    faces = soup.faces.copy()
    faces[rows] = faces[rows][:, ::-1]
    closed = close_surface(TriangleMesh(soup.vertices, faces), "auto", COARSE)
    assert closed.repair == "turned"
    assert closed.surface.volume == pytest.approx(6, rel=1e-12)


def test_a_body_apart_is_turned_and_a_void_stays():
    void, other = turned(box((0.5, 0.5, 0.5))), turned(box((1, 1, 1), (3, 0, 0)))
    for soup in (join(box(), void, other), turned(join(box(), void, other))):
        found = turn_outward(soup)
        assert found.volume == pytest.approx(2 - 0.125, rel=1e-12)
        assert count_pieces(found) == 2


@pytest.mark.parametrize(
    ("soup", "reason"),
    [
        (without_side(box(), 1, 1), "not closed: 4 open or misoriented edges"),
        (join(box(), box((1, 1, 1), (0.5, 0.25, 0.125))), "meets itself"),
    ],
)
def test_what_encloses_nothing_or_meets_itself_is_wrapped(soup, reason):
    closed = close_surface(soup, "auto", COARSE)
    assert closed.repair == "alpha_wrap"
    assert closed.reason.startswith(reason)
    low, high = soup.vertices.min(axis=0), soup.vertices.max(axis=0)
    np.testing.assert_allclose(closed.surface.vertices.min(axis=0), low, atol=0.01)
    np.testing.assert_allclose(closed.surface.vertices.max(axis=0), high, atol=0.01)


def test_without_repair_an_open_surface_is_refused():
    with pytest.raises(ShapeError, match="not closed: 4 open or misoriented edges; it needs a repair"):
        close_surface(without_side(box(), 1, 1), "none", COARSE)
