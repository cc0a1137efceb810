"""The camera that figures share."""

import numpy as np
import pytest
import trimesh

from tetgan.rendering.view import View


def box(low, high) -> tuple[np.ndarray, np.ndarray]:
    mesh = trimesh.creation.box(bounds=[low, high])
    return np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)


def covered(image: np.ndarray) -> np.ndarray:
    return (image < 250).any(axis=2)


def test_the_middle_of_the_cube_is_the_middle_of_every_picture():
    # Half of the front of the cube, from the left wall to the middle, in a picture two sides wide.
    vertices, faces = box((0, 0, 0), (0.5, 1, 1))
    image = View(size=(100, 100), azimuth=0, elevation=0, span=2.0).draw(vertices, faces)
    expected = np.zeros((100, 100), dtype=bool)
    expected[25:75, 25:50] = True
    assert np.array_equal(covered(image), expected)


@pytest.mark.parametrize("azimuth", [0, 35, 60, 211])
def test_the_whole_cube_fits_the_default_view(azimuth):
    image = covered(View(size=(80, 80), azimuth=azimuth).draw(*box((0, 0, 0), (1, 1, 1))))
    assert not image[[0, -1]].any() and not image[:, [0, -1]].any()


@pytest.mark.parametrize("size", [(100, 100), (160, 80), (80, 160)])
def test_a_close_view_holds_all_shapes_and_no_more(size):
    shapes = [box((0.4, 0.4, 0.4), (0.6, 0.6, 0.6)), box((0.3, 0.1, 0.45), (0.5, 0.7, 0.5))]
    view = View(size=size).close_to(vertices for vertices, _ in shapes)
    pictures = [covered(view.draw(*shape)) for shape in shapes]
    for picture in pictures:
        assert not picture[[0, -1]].any() and not picture[:, [0, -1]].any()
    # Along the side that decides, vertices reach to 1 / 1.06 = 94 % of the way to the frame, at both ends.
    ink = np.any(pictures, axis=0)
    rows, columns = (np.flatnonzero(ink.any(axis=axis)) for axis in (1, 0))
    gaps = [(rows[0], size[1] - 1 - rows[-1], size[1]), (columns[0], size[0] - 1 - columns[-1], size[0])]
    assert all(abs(before - after) <= 1 for before, after, _ in gaps)
    assert min(before / side for before, _, side in gaps) == pytest.approx((1 - 1 / 1.06) / 2, abs=0.015)


def test_a_point_is_where_its_pixel_is_drawn():
    vertices, faces = box((0.6, 0.7, 0.5), (0.62, 0.72, 0.52))
    view = View(size=(200, 100), middle=(0.4, 0.6, 0.9))
    rows, columns = np.nonzero(covered(view.draw(vertices, faces)))
    ((column, row),) = view.pixels(vertices.mean(axis=0, keepdims=True))
    assert (columns.mean() + 0.5, rows.mean() + 0.5) == pytest.approx((column, row), abs=0.6)


def test_without_shapes_the_view_stays():
    assert View().close_to([]) == View()
    assert (View(size=(30, 20)).blank == 255).all() and View(size=(30, 20)).blank.shape == (20, 30, 3)
