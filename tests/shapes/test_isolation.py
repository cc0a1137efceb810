"""The child may crash, hang, raise or chatter: each costs one mesh."""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from soups import box

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.isolation import RepairWorker
from tetgan.shapes.options import RepairOptions

_SECONDS = 0.5


def _order(number: int) -> TriangleMesh:
    soup = box()
    vertices = soup.vertices.copy()
    vertices[0, 0] = number
    return TriangleMesh(vertices, soup.faces)


@pytest.fixture(scope="module")
def worker() -> Iterator[RepairWorker]:
    program = (sys.executable, str(Path(__file__).with_name("fake_worker.py")), str(_SECONDS))
    with RepairWorker(RepairOptions(timeout_seconds=_SECONDS), program) as worker:
        yield worker


@pytest.mark.parametrize(
    ("order", "reason"),
    [
        (1, "crashed"),
        (2, r"longer than 0\.5 s"),
        (3, "hangs"),
        (4, "no such luck"),
        (5, r"crashed \(exit status 7\)"),
        (7, "MemoryError"),
    ],
)
def test_a_bad_end_costs_one_mesh(worker: RepairWorker, monkeypatch, order: int, reason: str) -> None:
    worker.repair(_order(0))  # the child has started: only a sleeper is lost patience with
    if reason == "hangs":
        monkeypatch.setattr(worker, "_patience", 1.0)
    with pytest.raises(ShapeError, match=reason):
        worker.repair(_order(order))
    monkeypatch.undo()
    np.testing.assert_array_equal(worker.repair(_order(0)).vertices, _order(0).vertices)


def test_what_a_library_prints_does_not_mix_with_answers(worker: RepairWorker) -> None:
    assert len(worker.repair(_order(6)).faces) == 12


def test_the_child_lives_on_from_mesh_to_mesh(worker: RepairWorker) -> None:
    worker.repair(_order(0))
    child = worker._process
    worker.repair(_order(0))
    assert worker._process is child


def test_a_large_mesh_passes_through_whole() -> None:
    soup = TriangleMesh(np.random.default_rng(0).random((200_000, 3)), np.arange(199_998).reshape(-1, 3))
    program = (sys.executable, str(Path(__file__).with_name("fake_worker.py")), "60")
    with RepairWorker(RepairOptions(), program) as worker:
        returned = worker.repair(soup)
    np.testing.assert_array_equal(returned.vertices, soup.vertices)
    np.testing.assert_array_equal(returned.faces, soup.faces)


def test_closing_ends_the_child() -> None:
    program = (sys.executable, str(Path(__file__).with_name("fake_worker.py")), "60")
    with RepairWorker(RepairOptions(), program) as worker:
        worker.repair(_order(0))
        child = worker._process
        assert child is not None
    assert child.poll() is not None
