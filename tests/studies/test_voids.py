"""Hollows are counted; islands and inverted crumbs are not."""

import numpy as np
import trimesh

from tetgan.studies.voids import count_voids


def joined(*parts: trimesh.Trimesh) -> int:
    mesh = trimesh.util.concatenate(parts)
    return count_voids(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))


def cube(side: float, *place: float, inward: bool = False) -> trimesh.Trimesh:
    mesh = trimesh.creation.box((side, side, side))
    mesh.apply_translation(place)
    if inward:
        mesh.invert()
    return mesh


def test_hollows_are_counted():
    outer = cube(1, 0, 0, 0)
    hollow, another = (cube(0.2, x, 0, 0, inward=True) for x in (0, 0.3))
    assert joined(outer) == 0
    assert joined(outer, hollow) == 1
    assert joined(outer, hollow, another, cube(1, 3, 0, 0)) == 2


def test_what_lies_outside_is_no_hollow():
    assert joined(cube(1, 0, 0, 0), cube(0.2, 2, 0, 0)) == 0
    assert joined(cube(1, 0, 0, 0), cube(0.2, 2, 0, 0, inward=True)) == 0
    assert joined(cube(1, 0, 0, 0, inward=True)) == 0


def test_nothing_has_no_hollows():
    assert count_voids(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)) == 0
