"""Pairs and triples chosen by the rule, the same ones every time."""

import numpy as np
import pytest

from tetgan.fields.field import Field
from tetgan.studies.latent.choosing import choose_pairs, choose_triples, difference

THRESHOLD = 0.05


@pytest.fixture(scope="module")
def fields(store) -> dict[str, Field]:
    return {shape_id: store.read(shape_id) for shape_id in store.ids("validation")}


def test_the_difference_of_a_chair_and_a_stool_is_the_back(fields, store):
    grid = store.hierarchy.finest
    found = difference(fields["wide-back"], fields["wide"], grid, THRESHOLD)
    back = (grid.centroids[:, 1] > 0.5) & fields["wide-back"].occupancy
    assert found.added.any() and not found.removed.any()
    assert (found.added <= back).all()
    # What is left of the back lies within the threshold above the seat.
    assert (grid.centroids[back & ~found.added, 1] <= 0.5 + THRESHOLD).all()
    assert (found.box >= found.added).all()
    assert grid.centroids[found.box, 1].min() > 0.5 - THRESHOLD


def test_the_difference_turned_round_swaps_its_parts(fields, store):
    grid = store.hierarchy.finest
    one = difference(fields["wide-back"], fields["pole"], grid, THRESHOLD)
    other = difference(fields["pole"], fields["wide-back"], grid, THRESHOLD)
    assert np.array_equal(one.added, other.removed) and np.array_equal(one.removed, other.added)
    assert np.array_equal(one.box, other.box)


def test_the_clearest_triple_adds_a_back_to_the_narrow_stool(fields, store):
    (triple,) = choose_triples(fields, store.hierarchy.finest, 5, THRESHOLD)
    assert triple[:3] == ("wide-back", "wide", "narrow")
    assert triple.kept > 0.7 and 0.05 < triple.part < 0.5


def test_the_order_of_the_shapes_makes_no_difference(store):
    everything = {i: store.read(i) for i in (*store.ids("train"), *store.ids("validation"))}
    grid = store.hierarchy.finest
    triples = choose_triples(everything, grid, 3, THRESHOLD)
    assert choose_triples(dict(reversed(everything.items())), grid, 3, THRESHOLD) == triples
    assert choose_triples(everything, grid, 1, THRESHOLD) == triples[:1]
    used = [shape_id for triple in triples for shape_id in triple[:3]]
    assert len(triples) == 3 and len(set(used)) == 9


def test_too_few_shapes_or_equal_ones_make_no_triple(fields, store):
    grid = store.hierarchy.finest
    assert choose_triples({}, grid, 2, THRESHOLD) == []
    assert choose_triples({"a": fields["wide"], "b": fields["pole"]}, grid, 2, THRESHOLD) == []
    assert choose_triples(dict.fromkeys("abcd", fields["wide"]), grid, 2, THRESHOLD) == []


def test_pairs_are_disjoint_and_depend_on_the_seed_alone():
    ids = [f"s{i}" for i in range(9)]
    pairs = choose_pairs(ids, 3, seed=0)
    assert len({shape for pair in pairs for shape in pair}) == 6
    assert choose_pairs(ids[::-1], 3, seed=0) == pairs != choose_pairs(ids, 3, seed=1)
    assert choose_pairs(ids, 2, seed=0) == pairs[:2]
    assert len(choose_pairs(ids, 50, seed=0)) == 4 and choose_pairs(["a"], 3, seed=0) == []
