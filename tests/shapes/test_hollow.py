"""Hollow shapes are found, on solids with walls of known thickness."""

import numpy as np
import pytest
from soups import box, join, lathe

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.hollow import find_hollow, hollow_voxels

_SHEET = 0.01


def _cavity(outer: TriangleMesh, inner: TriangleMesh) -> TriangleMesh:
    """The solid between two closed surfaces."""
    return join(outer, TriangleMesh(inner.vertices, inner.faces[:, ::-1]))


def _volume(soup: TriangleMesh) -> float:
    return float(np.linalg.det(soup.triangles).sum() / 6)


def _cup(wall: float, opening: float, depth: float = 1.0) -> TriangleMesh:
    """Closed surface of a jar of radius 0.5 open at the top, with walls of a thickness."""
    inner = 0.5 - wall
    profile = [(1e-6, 0.0), (0.5, 0.0), (0.5, depth), (opening, depth), (opening, depth - wall)]
    return lathe([*profile, (inner, depth - wall), (inner, wall), (1e-6, wall)])


@pytest.mark.parametrize("wall", [0.002, 0.008])
def test_a_shell_around_nothing_is_hollow_and_its_plug_fills_it(wall: float) -> None:
    solid = _cavity(box(), box(size=(1 - 2 * wall,) * 3))
    plug = find_hollow(solid, _SHEET)
    assert plug is not None
    # Snapped to one side of the walls or the other; its edges are cut by at most a voxel of 1/40.
    assert 0.97 * (1 - 2 * wall) ** 3 < _volume(plug) <= 1
    assert np.abs(plug.vertices).max() <= 0.5 + 1e-9


def test_a_cavity_in_thick_walls_is_the_shape_s_own() -> None:
    assert find_hollow(_cavity(box(), box(size=(0.9, 0.9, 0.9))), _SHEET) is None


def test_solids_are_not_hollow() -> None:
    assert find_hollow(box(), _SHEET) is None
    table = join(
        box((1, 0.005, 1), (0, 0.5, 0)),
        *(box((0.05, 1, 0.05), (x, 0, z)) for x in (-0.4, 0.4) for z in (-0.4, 0.4)),
    )
    assert find_hollow(table, _SHEET) is None


@pytest.mark.parametrize(("wall", "hollow"), [(0.004, True), (0.05, False)])
def test_a_jar_is_hollow_only_if_its_wall_is_a_sheet(wall: float, hollow: bool) -> None:
    assert (find_hollow(_cup(wall, opening=0.2), _SHEET) is not None) == hollow


def test_a_bowl_of_sheet_stays_a_bowl() -> None:
    angles = np.linspace(0.002, np.pi / 2, 12)
    profile = [(r * np.sin(a), -r * np.cos(a)) for r, turn in ((0.5, 1), (0.496, -1)) for a in angles[::turn]]
    assert find_hollow(lathe(profile), _SHEET) is None


def test_a_hollow_ends_at_a_sheet_that_no_voxel_resolves() -> None:
    """A hollow box beside a niche: they are parted by a wall a tenth of a voxel thick."""
    wall = 0.0025
    hollow = _cavity(box(), box(size=(1 - 2 * wall,) * 3))
    niche = [box((1, wall, 1), (1, 0.5 - wall / 2, 0)), box((1, wall, 1), (1, -0.5 + wall / 2, 0))]
    voxels, origin, step = hollow_voxels(join(hollow, *niche), _SHEET)
    centres = origin + step * np.argwhere(voxels)
    assert centres[:, 0].max() < 0.5
    assert len(centres) * step**3 == pytest.approx(1.0, abs=0.15)
