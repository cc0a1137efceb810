"""Packed solids: they unpack to what they were, within a known error."""

import base64
import shutil

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.errors import UserError
from tetgan.geometry.tets import dihedral_angles, radius_ratios
from tetgan.report.solids import REGULAR_DIHEDRAL, find_sample_sets, pack_sets, pack_solid


def unpack(packed):
    """What the page's script does."""
    codes = np.frombuffer(base64.b64decode(packed["positions"]), "<u2").reshape(-1, 3)
    kind = "<u4" if packed["wide"] else "<u2"
    tets = np.frombuffer(base64.b64decode(packed["tets"]), kind).reshape(-1, 4)
    return np.array(packed["low"]) + packed["step"] * codes.astype(float), tets


def codes_of(packed, name):
    return np.frombuffer(base64.b64decode(packed[name]), "u1")


@given(seed=st.integers(0, 2**32 - 1), size=st.floats(1e-3, 1e3))
@settings(max_examples=30, deadline=None)
def test_a_solid_unpacks_to_itself(seed, size):
    rng = np.random.default_rng(seed)
    vertices = size * rng.normal(size=(30, 3))
    tets = np.array([rng.choice(30, 4, replace=False) for _ in range(12)])
    packed = pack_solid(vertices, tets)
    found, found_tets = unpack(packed)
    used = vertices[np.unique(tets)]
    step = (used.max(axis=0) - used.min(axis=0)).max() / 65535
    assert packed["step"] == pytest.approx(step)
    # Half a step of rounding, and a little of the arithmetic.
    assert np.abs(found[found_tets] - vertices[tets]).max() <= 0.5001 * step
    assert (packed["vertices"], packed["count"]) == (len(used), 12)


def test_quality_is_packed_by_tet(ball):
    vertices, tets = ball
    tets = tets.copy()
    tets[3] = tets[3, [1, 0, 2, 3]]
    packed = pack_solid(vertices, tets)
    dihedral, ratio = codes_of(packed, "dihedral"), codes_of(packed, "ratio")
    assert packed["inverted"] == 1
    assert np.flatnonzero(dihedral == 255).tolist() == np.flatnonzero(ratio == 255).tolist() == [3]
    others = np.arange(len(tets)) != 3
    angles = dihedral_angles(vertices, tets).min(axis=1)[others]
    np.testing.assert_allclose(dihedral[others] / 254 * REGULAR_DIHEDRAL, angles, atol=REGULAR_DIHEDRAL / 508)
    np.testing.assert_allclose(ratio[others] / 254, radius_ratios(vertices, tets)[others], atol=1 / 508)
    assert packed["smallest"] == pytest.approx(angles.min(), abs=0.005)


def test_many_vertices_need_wider_indices():
    count = 65540
    vertices = np.random.default_rng(0).random((count, 3))
    tets = np.arange(count).reshape(-1, 4)
    packed = pack_solid(vertices, tets)
    assert packed["wide"]
    assert np.array_equal(unpack(packed)[1], tets)
    assert not pack_solid(vertices[:65536], tets[:16384])["wide"]


def test_a_solid_without_tets_is_refused():
    with pytest.raises(ValueError, match="without tets"):
        pack_solid(np.zeros((4, 3)), np.empty((0, 4), dtype=np.int64))


def test_all_inverted_has_no_smallest_angle():
    corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert pack_solid(corner, np.array([[1, 0, 2, 3]]))["smallest"] is None


def test_the_lowest_seed_and_the_first_samples_are_taken(results):
    sets = find_sample_sets(results / "samples", ["tetgan-LR"], 2)
    assert [(one.model, one.seed, one.mode, one.smoothing) for one in sets] == [
        ("tetgan-LR", 0, "paper", "wls")
    ]
    assert [path.stem for path in sets[0].paths] == ["0000", "0001"]
    assert [one.model for one in find_sample_sets(results / "samples", [], 2)] == ["pca", "tetgan-LR"]


def test_valid_solids_stand_before_the_papers(tmp_path, results):
    paper = results / "samples/chair/tetgan-LR/0/paper"
    for mode in ("paper", "solid"):
        shutil.copytree(paper, tmp_path / "chair/tetgan-LR/0" / mode)
    assert [one.mode for one in find_sample_sets(tmp_path, [], 1)] == ["solid", "paper"]


def test_a_set_tells_how_many_of_its_solids_are_valid(tmp_path, results):
    shutil.copytree(results / "samples", tmp_path, dirs_exist_ok=True)
    rows = "set,id,tets,valid\n" + "".join(
        f"{kind},{number},{tets},{valid}\n"
        for kind, number, tets, valid in (
            ("generated", "0000", 4, True),
            ("generated", "0001", 4, False),
            ("generated", "0002", 0, False),  # empty
            ("reconstructed", "a", 4, False),
        )
    )
    (tmp_path / "chair/pca/0/paper/wls/certificate.csv").write_text(rows)
    told = {one["model"]: one["validity"] for one in pack_sets(find_sample_sets(tmp_path, [], 1))}
    assert told == {"pca": "1 of 2 valid", "tetgan-LR": ""}


def test_a_model_without_solids_is_named(results):
    with pytest.raises(UserError, match="'absent'"):
        find_sample_sets(results / "samples", ["absent"], 2)


def test_every_set_gets_one_before_any_gets_two(results):
    sets = find_sample_sets(results / "samples", [], 3)
    whole = pack_sets(sets)
    one = sum(len(value) for value in whole[0]["solids"][0].values() if isinstance(value, str))
    assert [len(part["solids"]) for part in whole] == [3, 3]
    assert [len(part["solids"]) for part in pack_sets(sets, budget=int(2.5 * one))] == [1, 1]
    assert [len(part["solids"]) for part in pack_sets(sets, budget=int(1.5 * one))] == [1]


def test_a_broken_file_is_named(results, tmp_path):
    path = tmp_path / "chair/m/0/paper/none/generated/0000.vtu"
    path.parent.mkdir(parents=True)
    path.write_text("<broken")
    with pytest.raises(UserError, match=r"0000\.vtu"):
        pack_sets(find_sample_sets(tmp_path, [], 1))
