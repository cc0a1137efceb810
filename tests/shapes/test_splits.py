"""Training, validation and hold-out split."""

from collections import Counter

from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.shapes.entries import ShapeEntry, assign_splits
from tetgan.shapes.options import SplitOptions


def _entries(count: int, split: str | None = None, prefix: str = "s") -> list[ShapeEntry]:
    return [ShapeEntry(f"{prefix}{number:04d}", str(number), split) for number in range(count)]


def test_five_train_where_one_validates() -> None:
    counts = Counter(assign_splits(_entries(600), SplitOptions()).values())
    assert counts == {"train": 500, "validation": 100}


@settings(deadline=None)
@given(count=st.integers(0, 80), seed=st.integers(0, 99), order=st.randoms())
def test_every_shape_has_a_split_whatever_order_they_come_in(count: int, seed: int, order) -> None:
    entries, options = _entries(count), SplitOptions(seed=seed)
    splits = assign_splits(entries, options)
    assert set(splits) == {entry.id for entry in entries}
    shuffled = entries.copy()
    order.shuffle(shuffled)
    assert assign_splits(shuffled, options) == splits


def test_the_seed_decides_and_a_source_s_own_split_stands() -> None:
    free = _entries(60)
    assert assign_splits(free, SplitOptions(seed=0)) != assign_splits(free, SplitOptions(seed=1))
    official = _entries(5, "validation", "v") + _entries(7, "holdout", "h")
    mixed = assign_splits(free + official, SplitOptions())
    assert {mixed[entry.id] for entry in official[:5]} == {"validation"}
    assert {mixed[entry.id] for entry in official[5:]} == {"holdout"}
    assert assign_splits(free, SplitOptions()).items() <= mixed.items()
