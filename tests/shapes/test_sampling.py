"""Samples of surfaces, and of what can be seen of raw ones."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from soups import box, join, without_side

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.sampling import sample_exterior, sample_surface

_LEVEL = 1e-9  # points are convex combinations of corners of size 1


def _on_box(points: np.ndarray, size: float = 1.0) -> np.ndarray:
    """Which points lie on the surface of the cube of a size about the origin."""
    return np.isclose(np.abs(points).max(axis=1), size / 2, atol=_LEVEL)


def test_points_lie_on_the_surface_in_proportion_to_area() -> None:
    soup = box(size=(1, 2, 4))  # sides of areas 8, 4 and 2, each twice
    points, normals = sample_surface(soup.vertices, soup.faces, 14_000, seed=0)
    sides = np.abs(normals).argmax(axis=1)
    for axis, area in enumerate((8, 4, 2)):
        on_side = sides == axis
        np.testing.assert_allclose(np.abs(points[on_side, axis]), soup.vertices[:, axis].max(), atol=_LEVEL)
        # Binomial: the standard deviation is below 60.
        assert on_side.sum() == pytest.approx(1000 * area, abs=300)


def test_a_face_without_area_is_never_hit() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]], dtype=float)
    points, normals = sample_surface(vertices, np.array([[3, 3, 3], [0, 1, 2], [1, 1, 3]]), 500, seed=1)
    assert np.isfinite(normals).all()
    assert (points[:, 2] == 0).all()
    with pytest.raises(ValueError, match="area"):
        sample_surface(vertices, np.array([[3, 3, 3]]), 5, seed=0)


@pytest.mark.parametrize("sample", [sample_surface, sample_exterior])
def test_a_seed_fixes_the_points(sample) -> None:
    soup = box()
    first, again, other = (sample(soup.vertices, soup.faces, 100, seed)[0] for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_what_is_inside_is_never_sampled() -> None:
    soup = join(box(), box(size=(0.5, 0.5, 0.5)), box(size=(0.2, 0.2, 0.2)))
    points, normals = sample_exterior(soup.vertices, soup.faces, 2000, seed=0)
    assert _on_box(points).all()
    assert ((points * normals).sum(axis=1) > 0).all()  # outward


@settings(max_examples=15, deadline=None)
@given(flips=st.integers(0, 2**12 - 1), doubles=st.integers(0, 2**12 - 1))
def test_flipped_and_doubled_faces_play_no_part(flips: int, doubles: int) -> None:
    soup = box()
    flipped = np.array([flips >> face & 1 for face in range(12)], dtype=bool)
    doubled = np.array([doubles >> face & 1 for face in range(12)], dtype=bool)
    faces = np.where(flipped[:, None], soup.faces[:, ::-1], soup.faces)
    faces = np.concatenate([faces, faces[doubled][:, ::-1]])
    points, normals = sample_exterior(soup.vertices, faces, 1200, seed=0)
    assert ((points * normals).sum(axis=1) > 0).all()
    # 200 on each of six sides, give or take a standard deviation of 13
    sides = np.abs(normals).argmax(axis=1) * 2 + (normals.sum(axis=1) > 0)
    assert np.bincount(sides, minlength=6) == pytest.approx(np.full(6, 200), abs=65)


def test_overlapping_parts_show_only_their_union() -> None:
    soup = join(box(), box(centre=(0.5, 0.25, 0.0)))
    points, _ = sample_exterior(soup.vertices, soup.faces, 3000, seed=0)
    inside_first = (np.abs(points) < 0.5 - 1e-3).all(axis=1)
    inside_second = (np.abs(points - [0.5, 0.25, 0.0]) < 0.5 - 1e-3).all(axis=1)
    assert not (inside_first | inside_second).any()


def test_the_inside_of_an_open_box_can_be_seen() -> None:
    soup = without_side(box(), axis=1, side=1)
    _, normals = sample_exterior(soup.vertices, soup.faces, 500, seed=0)
    assert len(normals) == 500


def test_a_shape_that_hides_everything_is_an_error_not_a_loop() -> None:
    tiny = box(size=(1e-3, 1e-3, 1e-3))
    hidden = join(*(box(size=(s, s, s)) for s in np.linspace(0.5, 0.999, 100)), tiny)
    soup = TriangleMesh(hidden.vertices, hidden.faces)
    with pytest.raises(ValueError, match="seen from outside"):
        sample_exterior(soup.vertices, soup.faces, 1000, seed=0)
