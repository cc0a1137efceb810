"""Built-in shapes of every category."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from tetgan.errors import UserError
from tetgan.geometry.triangles import join_meshes
from tetgan.shapes.builtin.generate import CATEGORIES, FLAWED_SHARE, MAKERS, damage_parts, generate_shape

# Chamfer distance of two samples of one surface, 10,000 points each, in the unit cube.
NOISE_FLOOR = 2e-4


@given(category=st.sampled_from(CATEGORIES), index=st.integers(0, 10**6), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_every_shape_is_a_sound_soup(category, index, seed):
    shape = generate_shape(category, index, seed)
    assert np.isfinite(shape.vertices).all()
    assert shape.faces.min() >= 0 and shape.faces.max() < len(shape.vertices)
    corners = shape.vertices[shape.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert areas.min() > 1e-12
    extents = np.ptp(shape.vertices, axis=0)
    assert extents.min() > 0.2 and extents.max() < 8.0
    # Legs are cut square to their axes, so a leaning one dips a little below the floor.
    assert -0.04 < shape.vertices[:, 1].min() < 0.1


@pytest.mark.parametrize("category", CATEGORIES)
def test_same_arguments_same_bytes(category):
    first, again = generate_shape(category, 7, 3), generate_shape(category, 7, 3)
    assert first.vertices.tobytes() == again.vertices.tobytes()
    assert first.faces.tobytes() == again.faces.tobytes()


@pytest.mark.parametrize("category", CATEGORIES)
def test_index_and_seed_matter(category):
    shapes = [generate_shape(category, index, seed) for index, seed in ((0, 0), (1, 0), (0, 1))]
    assert len({shape.vertices.tobytes() for shape in shapes}) == 3


def test_a_shape_does_not_depend_on_how_many_are_made():
    alone = generate_shape("chair", 5, 0).vertices
    after_others = [generate_shape("chair", index, 0).vertices for index in range(6)][5]
    assert alone.tobytes() == after_others.tobytes()


def test_an_unknown_category_is_a_user_error():
    with pytest.raises(UserError, match="sofa"):
        generate_shape("spoon", 0, 0)


def test_chairs_have_many_structural_kinds():
    backs = {generate_shape("chair", index, 0).structure.split("/")[0] for index in range(100)}
    assert len(backs) >= 12


@pytest.mark.parametrize(
    ("category", "least"), [("sofa", 8), ("bench", 15), ("table", 20), ("car", 8), ("vase", 10)]
)
def test_other_categories_have_many_kinds(category, least):
    kinds = {generate_shape(category, index, 0).structure.split("/")[0] for index in range(100)}
    assert len(kinds) >= least


def test_flaws_strike_their_share_and_add_no_surface():
    struck = 0
    for index in range(200):
        parts, _ = MAKERS["table"](np.random.default_rng(index))
        damaged = damage_parts(np.random.default_rng([index, 1]), parts)
        sound, flawed = join_meshes(parts), join_meshes(damaged)
        assert np.array_equal(sound.vertices, flawed.vertices)
        assert set(map(frozenset, flawed.faces.tolist())) <= set(map(frozenset, sound.faces.tolist()))
        struck += not np.array_equal(sound.faces, flawed.faces)
    # Three standard deviations of a binomial share.
    assert abs(struck / 200 - FLAWED_SHARE) < 3 * np.sqrt(FLAWED_SHARE * (1 - FLAWED_SHARE) / 200)


def surface_points(index: int, count: int) -> np.ndarray:
    """Area-uniform points of a chair whose bounding box fills the unit cube but for a margin of 0.02."""
    shape = generate_shape("chair", index, 0)
    extents = np.ptp(shape.vertices, axis=0)
    corners = (shape.vertices * 0.96 / extents.max())[shape.faces]
    corners -= (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rng = np.random.default_rng(index)
    chosen = corners[rng.choice(len(areas), count, p=areas / areas.sum())]
    root, along = np.sqrt(rng.random(count))[:, None], rng.random(count)[:, None]
    return chosen[:, 0] * (1 - root) + chosen[:, 1] * root * (1 - along) + chosen[:, 2] * root * along


def chamfer(a: np.ndarray, b: np.ndarray) -> float:
    return float(sum((cKDTree(x).query(y)[0] ** 2).mean() for x, y in ((a, b), (b, a))))


def nearest_pair(count: int, candidates: int) -> float:
    """Least Chamfer distance among chairs, measured on the pairs whose coarse occupancy is most alike."""
    clouds = [surface_points(index, 10_000) for index in range(count)]
    cells = np.stack([np.histogramdd(cloud, bins=8, range=[(-0.5, 0.5)] * 3)[0].ravel() for cloud in clouds])
    pairs = list(itertools.combinations(range(count), 2))
    unlike = np.array([np.abs(cells[i] - cells[j]).sum() for i, j in pairs])
    return min(chamfer(clouds[i], clouds[j]) for i, j in (pairs[k] for k in unlike.argsort()[:candidates]))


def test_chairs_differ_by_more_than_sampling_noise():
    assert nearest_pair(60, candidates=40) > NOISE_FLOOR


@pytest.mark.slow
def test_four_hundred_chairs_differ_by_more_than_sampling_noise():
    assert nearest_pair(400, candidates=800) > NOISE_FLOOR
