"""Ray-cast pictures of triangles."""

import numpy as np
import pytest
import trimesh

from tetgan.rendering.raycast import render_mesh

CUBE = trimesh.creation.box()
VERTICES, FACES = np.asarray(CUBE.vertices, dtype=float), np.asarray(CUBE.faces, dtype=np.int64)


def covered(image: np.ndarray) -> np.ndarray:
    return (image < 250).any(axis=2)


def test_silhouette_of_a_cube_seen_from_the_front():
    # The unit cube in a picture two units wide: a quarter of the area, in the middle.
    image = render_mesh(VERTICES, FACES, size=(100, 100), azimuth=0, elevation=0, span=2.0)
    expected = np.zeros((100, 100), dtype=bool)
    expected[25:75, 25:75] = True
    assert np.array_equal(covered(image), expected)


def test_silhouette_of_a_cube_seen_over_an_edge():
    # Turned by 45 degrees the cube is sqrt(2) wide and still 1 tall.
    image = render_mesh(VERTICES, FACES, size=(200, 200), azimuth=45, elevation=0, span=2.0)
    assert covered(image).mean() == pytest.approx(np.sqrt(2) / 4, abs=0.005)


def test_a_shape_fills_the_picture_but_for_a_margin():
    rows, columns = np.nonzero(covered(render_mesh(VERTICES, FACES, size=(200, 100))))
    assert rows.min() >= 3 and rows.max() <= 96
    assert rows.max() - rows.min() >= 90
    assert columns.min() + columns.max() == pytest.approx(199, abs=2)


def test_background_is_white_and_pictures_are_deterministic():
    image = render_mesh(VERTICES, FACES, size=(80, 60))
    assert image.shape == (60, 80, 3) and image.dtype == np.uint8
    assert (image[[0, 0, -1, -1], [0, -1, 0, -1]] == 255).all()
    assert np.array_equal(image, render_mesh(VERTICES, FACES, size=(80, 60)))


def test_winding_does_not_change_the_picture():
    flipped = FACES.copy()
    flipped[::2] = flipped[::2, ::-1]
    assert np.array_equal(
        render_mesh(VERTICES, FACES, size=(80, 80)), render_mesh(VERTICES, flipped, size=(80, 80))
    )


def test_the_front_is_towards_positive_z_and_right_is_positive_x():
    # A red face at +z, a green one at +x: the camera goes from one to the other.
    colors = np.tile([0.5, 0.5, 0.5], (len(FACES), 1))
    normals = CUBE.face_normals
    colors[normals[:, 2] > 0.5] = [0.8, 0, 0]
    colors[normals[:, 0] > 0.5] = [0, 0.8, 0]
    front = render_mesh(VERTICES, FACES, size=(60, 60), azimuth=0, elevation=0, colors=colors)[30, 30]
    side = render_mesh(VERTICES, FACES, size=(60, 60), azimuth=90, elevation=0, colors=colors)[30, 30]
    above = render_mesh(VERTICES, FACES, size=(60, 60), azimuth=0, elevation=60, colors=colors)
    assert front[0] > 100 > front[1] and side[1] > 100 > side[0]
    assert above[-12, 30, 0] > 100 > above[-12, 30, 1]


def test_size_and_place_of_the_mesh_do_not_matter():
    image = render_mesh(VERTICES, FACES, size=(80, 80))
    far = render_mesh(VERTICES * 1e-3 + 500.0, FACES, size=(80, 80))
    # float64 keeps 12 digits of the small cube far away, so at most some pixels of edges differ.
    assert (image != far).any(axis=2).mean() < 0.01


def test_shadow_darkens_what_lies_behind():
    floor = trimesh.creation.box((4, 0.1, 4))
    block = trimesh.creation.box((0.6, 2, 0.6), trimesh.transformations.translation_matrix((0, 1, 0)))
    scene = trimesh.util.concatenate([floor, block])
    open_floor = render_mesh(
        np.array(floor.vertices), np.array(floor.faces), size=(90, 90), elevation=60, span=6.0
    )
    shaded = render_mesh(
        np.array(scene.vertices), np.array(scene.faces), size=(90, 90), elevation=60, span=6.0
    )
    assert shaded[covered(shaded)].min() < 0.8 * open_floor[covered(open_floor)].min()


def test_an_empty_mesh_is_a_white_picture():
    image = render_mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), size=(30, 20))
    assert image.shape == (20, 30, 3) and (image == 255).all()


def test_a_flat_mesh_seen_on_edge_is_drawn():
    triangle = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1]])
    image = render_mesh(triangle, np.array([[0, 1, 2]]), size=(40, 40), elevation=0)
    assert image.shape == (40, 40, 3)
