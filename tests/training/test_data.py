"""Fields in memory and fields read ahead of use: the same batches, in the same order."""

import threading

import pytest
import torch

from tetgan.fields.store import FieldStore
from tetgan.training import data
from tetgan.training.data import CPU, ResidentFields, StreamedFields, open_fields

PLAN = [torch.tensor(rows) for rows in ([3, 1, 2], [0, 23], [5], [5, 5, 7], [22, 4, 6], [1, 0])]


@pytest.fixture(scope="module")
def store(tiny_index) -> FieldStore:
    return FieldStore.open(tiny_index)


def test_both_give_the_fields_of_the_store_in_half_precision(store):
    expected = torch.from_numpy(store.tensor([store.ids("train")[row] for row in PLAN[0]]))
    expected[..., 1:] = expected[..., 1:].half().float()
    for kind in (ResidentFields, StreamedFields):
        assert torch.equal(kind(store, "train").batch(PLAN[0]), expected)


def test_both_give_the_same_batches_in_the_order_of_the_plan(store):
    resident, streamed = (
        list(kind(store, "train").batches(PLAN)) for kind in (ResidentFields, StreamedFields)
    )
    assert len(resident) == len(streamed) == len(PLAN)
    assert all(torch.equal(a, b) for a, b in zip(resident, streamed, strict=True))


def test_both_have_the_same_digest_and_another_split_has_not(store):
    digests = [kind(store, "train").digest for kind in (ResidentFields, StreamedFields)]
    assert digests[0] == digests[1] != ResidentFields(store, "validation").digest


def test_batches_are_read_before_they_are_asked_for_but_not_far_before(store, monkeypatch):
    read = threading.Semaphore(0)
    count = []

    def tensor(ids):
        count.append(len(ids))
        read.release()
        return FieldStore.tensor(store, ids)

    fields = StreamedFields(store, "train")
    monkeypatch.setattr(store, "tensor", tensor)
    batches = fields.batches(PLAN)
    next(batches)
    for _ in range(1 + data.AHEAD):  # the batch itself, and those behind it
        assert read.acquire(timeout=30)
    assert len(count) == 1 + data.AHEAD < len(PLAN)
    batches.close()


def test_an_error_of_the_reading_thread_arrives_with_its_batch(store, monkeypatch):
    fields = StreamedFields(store, "train")
    batches = fields.batches([PLAN[0], torch.tensor([30])])
    monkeypatch.setattr(fields, "ids", [*fields.ids, *(6 * ["nobody"]), "nobody"])
    next(batches)
    with pytest.raises(KeyError, match="nobody"):
        next(batches)


def test_fields_are_kept_where_they_fit(store, monkeypatch):
    assert isinstance(open_fields(store, "train", CPU, "auto"), ResidentFields)
    assert isinstance(open_fields(store, "train", CPU, "streamed"), StreamedFields)
    needed = len(store.ids("train")) * 192 * 7
    monkeypatch.setattr(data, "_memory", lambda _: 4 * needed - 1)
    assert isinstance(open_fields(store, "train", CPU, "auto"), StreamedFields)
    assert isinstance(open_fields(store, "train", CPU, "resident"), ResidentFields)
