"""Thickness of shapes with known answers."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.solids.record import median_thickness

# Rays are cast in single precision, from 1e-5 behind the face.
PRECISION = 1e-5


def thickness(mesh: trimesh.Trimesh) -> float:
    return median_thickness(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))


@given(st.floats(0.01, 0.45))
@settings(max_examples=20, deadline=None)
def test_a_plate_is_as_thick_as_between_its_sides(thin):
    # The rays from its rim run through all of it, but the rim is the smaller half of its area.
    assert thickness(trimesh.creation.box((1.0, thin, 1.0))) == pytest.approx(thin, abs=PRECISION)


def test_a_rod_is_as_thick_as_it_is_wide():
    assert thickness(trimesh.creation.box((0.1, 0.1, 1.0))) == pytest.approx(0.1, abs=PRECISION)


def test_a_ball_has_its_diameter():
    # Faces of a sphere of 5,120 lie within 0.1 % of the radius inside it.
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.4)
    assert thickness(ball) == pytest.approx(0.8, rel=2e-3)


def test_a_tube_has_the_thickness_of_its_wall():
    tube = trimesh.creation.annulus(r_min=0.3, r_max=0.35, height=0.8, sections=96)
    assert thickness(tube) == pytest.approx(0.05, rel=0.02)


def test_size_and_place_do_not_matter():
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=0.2)
    moved = mesh.copy().apply_translation((0.5, 0.4, 0.6)).apply_scale(0.5)
    assert thickness(moved) == pytest.approx(thickness(mesh) / 2, rel=1e-3)


def test_the_larger_of_two_parts_decides():
    plate, ball = trimesh.creation.box((1.0, 0.1, 1.0)), trimesh.creation.icosphere(radius=0.1)
    ball.apply_translation((0, 0.5, 0))
    assert thickness(trimesh.util.concatenate([plate, ball])) == pytest.approx(0.1, abs=PRECISION)


def test_nothing_has_no_thickness():
    assert median_thickness(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)) == 0
    # A lone triangle has nothing behind it.
    assert median_thickness(np.eye(3), np.array([[0, 1, 2]])) == 0
