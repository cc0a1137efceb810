"""Overlap of volumes: boxes."""

from math import isnan

import numpy as np
import pytest
import trimesh

from tetgan.evaluation.reconstructions import volume_iou
from tetgan.geometry.triangles import TriangleMesh

POINTS = 20_000


def box(size=(1.0, 1.0, 1.0), at=(0.0, 0.0, 0.0)) -> TriangleMesh:
    made = trimesh.creation.box(size)
    return TriangleMesh(np.asarray(made.vertices) + np.array(at), np.asarray(made.faces, dtype=np.int64))


def test_a_shape_is_itself_whichever_way_it_faces():
    cube = box()
    assert volume_iou(cube, cube, POINTS, 0) == 1
    assert volume_iou(cube, TriangleMesh(cube.vertices, cube.faces[:, ::-1]), POINTS, 0) == 1


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        (box(at=(0.5, 0, 0)), 1 / 3),
        (box((0.5, 0.5, 0.5)), 1 / 8),
        (box(at=(3, 0, 0)), 0),
        (box((4, 1, 1)), 1 / 4),
    ],
)
def test_boxes_have_known_overlaps(other, expected):
    # At least a quarter of the points lies in either: the deviation is at most sqrt(p (1 - p) / 5000).
    assert volume_iou(box(), other, POINTS, 0) == pytest.approx(expected, abs=4 * 0.5 / 5000**0.5)


def test_scale_and_order_do_not_matter():
    first, second = box(), box(at=(0.3, 0.2, 0.1))
    large = [TriangleMesh(1000 * each.vertices + 7, each.faces) for each in (first, second)]
    value = volume_iou(first, second, POINTS, 0)
    assert volume_iou(second, first, POINTS, 0) == value
    assert volume_iou(*large, POINTS, 0) == pytest.approx(value, abs=1e-3)


def test_a_sheet_has_no_inside():
    sheet = TriangleMesh(np.eye(3), np.array([[0, 1, 2]]))
    assert isnan(volume_iou(sheet, sheet, POINTS, 0))
