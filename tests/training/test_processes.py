"""A batch cut among processes, and two processes against one."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file

from tetgan.methods.tetgan.options import TetganOptions
from tetgan.training import processes
from tetgan.training.processes import own_rows, shares

SMALL = TetganOptions.parse(
    {"grid": "smoke", "width": 4, "code": 8, "local_critic_width": 1, "global_critic_width": 2}
)
# 24 shapes in batches of 7: the last batch of an epoch has 3.
TRAINING = (
    "{epochs: 2, batch_size: 7, head_start: 0.25, adversarial_start: 0.5, adversarial_every: 2, ema: 0.9,"
    " gradient_clip: 1.0, picture_every: 1000, device: cpu, checkpoint_seconds: 0}"
)


@pytest.fixture
def place(monkeypatch):
    """Pretend to be one of several processes."""

    def be(number: int, count: int) -> None:
        monkeypatch.setattr(processes, "process_count", lambda: count)
        monkeypatch.setattr(processes, "process_place", lambda: number)

    return be


@pytest.mark.parametrize(
    ("rows", "count", "parts"), [(30, 1, 1), (30, 4, 1), (7, 2, 3), (5, 3, 4), (1, 1, 3)]
)
def test_shares_cover_a_batch_once_and_weigh_its_mean(place, rows, count, parts):
    values = torch.arange(rows, dtype=torch.float64) ** 2
    covered, means = [], []
    for number in range(count):
        place(number, count)
        own = values[own_rows(rows)]
        cut = shares(rows, parts)
        assert len(cut) <= parts
        assert all(torch.equal(own[share.own], values[share.rows]) for share in cut)
        covered += [torch.arange(rows)[share.rows] for share in cut]
        means.append(sum(share.weight * values[share.rows].mean() for share in cut))
    assert torch.equal(torch.cat(covered), torch.arange(rows))
    assert float(sum(means) / count) == pytest.approx(float(values.mean()), rel=1e-12)


def test_a_process_without_a_row_takes_one_that_does_not_count(place):
    weights = []
    for number in range(3):
        place(number, 3)
        assert len(torch.arange(2)[own_rows(2)]) == 1
        weights.append(sum(share.weight for share in shares(2, 2)))
    assert sorted(weights) == [0, 1.5, 1.5]


def train(index: Path, folder: Path, *further: str) -> list[dict[str, str]]:
    command = ["train", str(index), str(folder), "--model", SMALL.model_dump_json(), "--training", TRAINING]
    subprocess.run(
        [sys.executable, "-m", "tetgan", *command, "--threads", "1", *further],
        check=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        timeout=500,
    )
    with (folder / "log.csv").open() as stream:
        return list(csv.DictReader(stream))


def test_two_processes_train_like_one_with_the_whole_batch(tiny_index, tmp_path):
    """By gloo, with losses of a bypass, the latent head's start, critics, averages and clipping."""
    one, two = train(tiny_index, tmp_path / "one"), train(tiny_index, tmp_path / "two", "--processes", "2")
    for row, expected in zip(two, one, strict=True):
        for name in expected.keys() - {"seconds"}:
            # Single precision, sums in another order: 1e-7, enlarged by a few steps of Adam.
            assert (row[name] == "") == (expected[name] == "")
            if row[
                name
            ]:  # the ratio is of gradients of weights that Adam's first, sign-like steps moved apart
                loose = 1e-2 if name == "adversarial_ratio" else 1e-3
                assert float(row[name]) == pytest.approx(float(expected[name]), rel=loose, abs=1e-4), name
    weights, expected_weights = (
        load_file(tmp_path / name / "weights.safetensors") for name in ("two", "one")
    )
    for name, value in expected_weights.items():
        torch.testing.assert_close(weights[name], value, rtol=0, atol=1e-3, msg=name)
    assert sorted(p.name for p in (tmp_path / "two").iterdir()) == sorted(
        p.name for p in (tmp_path / "one").iterdir()
    )
