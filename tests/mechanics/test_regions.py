"""Regions by name and by box, supports and loads from text."""

import numpy as np
import pytest

from tetgan.errors import UserError
from tetgan.mechanics.assembly import Body
from tetgan.mechanics.errors import UnfitError
from tetgan.mechanics.regions import Load, Support, carry_over, choose_faces, parse_load, parse_support
from tetgan.mechanics.simulation import cut_tets
from tetgan.solids.regions import SIDES


@pytest.fixture(scope="module")
def faces(crooked):
    return Body(crooked.vertices * 2, crooked.tets, 1).boundary_faces(2.0)


@pytest.mark.parametrize("side", SIDES)
def test_a_side_is_the_face_of_the_cube_there(faces, side):
    axis, direction = SIDES[side]
    chosen = choose_faces(side, faces, 0.05)
    expected = np.isclose(faces.middles[:, axis], (direction + 1) / 2)
    assert np.array_equal(chosen, expected) and chosen.sum() == 32


def test_a_deep_side_takes_no_face_that_looks_elsewhere(faces):
    assert np.array_equal(choose_faces("top", faces, 1.0), choose_faces("top", faces, 0.0))


def test_a_side_starts_at_its_outermost_face_however_pointed_the_mesh():
    # A tet on its tip: all faces there are steep. Blunt, it has one that looks down.
    vertices = np.array([[0, 0, 0], [1, 3, 0], [0, 3, 1], [-1, 3, -1.0]])
    faces = Body(vertices, np.array([[0, 1, 2, 3]]), 1).boundary_faces(1.0)
    assert choose_faces("top", faces, 0.0).sum() == 1
    with pytest.raises(UnfitError):
        choose_faces("floor", faces, 1.0)
    blunt = np.concatenate([vertices[1:], [[0.2, 2.5, 0]]])
    assert choose_faces("floor", Body(blunt, np.array([[0, 1, 2, 3]]), 1).boundary_faces(1.0), 0.1).any()


def test_finer_faces_take_the_region_of_those_they_are_cut_from(crooked, faces):
    cut = cut_tets(crooked, 1)
    finer = Body(cut.vertices, cut.tets, 1).boundary_faces(1.0)
    for region in (*SIDES, "0,1,0:0.5,1,1"):
        chosen = choose_faces(region, faces, 0.05)
        assert carry_over(chosen, faces, finer).sum() == 4 * chosen.sum()
        assert np.array_equal(carry_over(chosen, faces, faces), chosen)


def test_a_box_holds_the_faces_centred_in_it(faces):
    half = choose_faces("0,1,0:0.5,1,1", faces, 0.05)
    assert half.sum() == 16
    assert np.array_equal(half, choose_faces("0.5,1,1:0,1,0", faces, 0.05))


def test_a_plane_holds_the_faces_in_it_and_either_side_of_one_those_beyond(faces):
    assert np.array_equal(choose_faces("y=1", faces, 0.05), choose_faces("top", faces, 0.05))
    below, above = (choose_faces(f"x{relation}0.5", faces, 0.05) for relation in "<>")
    assert (below ^ above).all() and below.sum() == above.sum() == 32 + 4 * 16
    assert choose_faces("surface", faces, 0.05).sum() == 6 * 32
    assert parse_load("y=1=500N") == Load("y=1", (0.0, -500.0, 0.0))
    assert parse_support("y<.1/y") == Support("y<.1", (False, True, False))


def test_an_empty_region_says_where_the_mesh_is(faces):
    with pytest.raises(UnfitError, match="spans 0,0,0:1,1,1") as caught:
        choose_faces("2,2,2:3,3,3", faces, 0.05)
    assert caught.value.kind == "empty region"


@pytest.mark.parametrize("region", ["ceiling", "0,0:1,1,1", "0,0,0", "a,b,c:1,1,1", ""])
def test_what_is_no_region_is_named(faces, region):
    with pytest.raises(UserError, match=f"region '{region}'"):
        choose_faces(region, faces, 0.05)


def test_supports_and_loads_read_as_they_are_written():
    assert parse_support("floor") == Support("floor", (True, True, True))
    assert parse_support("0,0,0:1,0,1/xz") == Support("0,0,0:1,0,1", (True, False, True))
    assert parse_load("top=500N") == Load("top", (0.0, -500.0, 0.0))
    assert parse_load("top=2.5 kN") == Load("top", (0.0, -2500.0, 0.0))
    assert parse_load("0,0,0:1,1,1=1,-2e1,.5N") == Load("0,0,0:1,1,1", (1.0, -20.0, 0.5))


@pytest.mark.parametrize("text", ["top", "top=500", "=5N", "top=1,2N", "top=fiveN", "top=nanN", "top=1e400N"])
def test_what_is_no_load_is_named(text):
    with pytest.raises(UserError, match=f"load: '{text}'"):
        parse_load(text)


def test_what_is_no_direction_is_named():
    with pytest.raises(UserError, match="floor/w"):
        parse_support("floor/w")
