"""Shapes that a source lists, and their names."""

import string

from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.shapes.entries import draw_entries, name_entries

_SAFE = set(string.ascii_letters + string.digits + "._-")


@settings(deadline=None)
@given(names=st.lists(st.text(max_size=150), max_size=12))
def test_ids_are_unique_and_safe_file_names(names: list[str]) -> None:
    entries = name_entries((name, f"{number}/{name}", None) for number, name in enumerate(names))
    ids = [entry.id for entry in entries]
    assert len({shape_id.lower() for shape_id in ids}) == len(names)
    assert ids == sorted(ids)
    for shape_id in ids:
        assert set(shape_id) <= _SAFE
        assert shape_id[0] not in ".-"
        assert 0 < len(shape_id) <= 120


def test_readable_names_stay_and_the_order_of_listing_does_not_matter() -> None:
    places = [("chairs/A", "chairs/A.obj", None), ("b.v2", "b.v2.off", "train"), ("../../etc", "x", None)]
    entries = name_entries(places)
    assert {entry.id for entry in entries} == {"chairs-A", "b.v2", "etc"}
    assert entries == name_entries(reversed(places))


@settings(deadline=None)
@given(count=st.integers(2, 40), limit=st.integers(2, 40))
def test_a_larger_limit_only_adds_shapes(count: int, limit: int) -> None:
    entries = name_entries((f"s{number}", f"s{number}", None) for number in range(count))
    drawn = draw_entries(entries, limit)
    assert len(drawn) == min(count, limit)
    assert set(drawn) <= set(draw_entries(entries, limit + 1))
    assert draw_entries(entries, None) == entries
