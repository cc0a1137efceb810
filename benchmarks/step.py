"""A whole iteration of training against the plain one of `naive_step`: same losses, time and memory.

python benchmarks/step.py --threads 2

An iteration is an autoencoder step, three critic steps and a step against the critics, on 9,216 tets (cells 2,
depth 2) in batches of 4. Widths 16/16/4: 16 channels at the finest level of autoencoder and global critic, 4 in
the local critic's first convolution; codes of 64 a coarse tet, as wide as the coarsest level. Both sides begin
with the same weights, and get the same fields and random numbers. Times are taken in turn in one process;
memory is what a process of its own takes more at its peak than before its first iteration, gradients and
moments of Adam included.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import torch
from naive_step import NaiveLearner
from torch import Tensor

from tetgan.fields.vertices import vertex_operator
from tetgan.grids.hierarchy import GridHierarchy, build_hierarchy
from tetgan.models.options import TetganOptions
from tetgan.training.learner import Learner
from tetgan.training.loop import step_draws
from tetgan.training.memory import keep_freed_memory
from tetgan.training.options import TrainingOptions

CELLS, DEPTH, BATCH = 2, 2, 4
MODEL = TetganOptions.parse(
    {
        **{"grid": "LR", "latent": "tet", "code": 64, "width": 16},
        **{"local_critic_width": 4, "global_critic_width": 16},
    }
)
TRAINING = TrainingOptions(batch_size=BATCH, device="cpu")
TOLERANCE = 1e-4  # of each loss, or of 0.01 where one is smaller: gaps are differences of means
SIDES = "naive", "ours"


class Side(Protocol):
    """What both learners can do."""

    def autoencoder_step(self, field: Tensor, kl_weight: float, draws: torch.Generator) -> dict[str, Any]: ...
    def critic_step(self, field: Tensor, draws: torch.Generator) -> dict[str, Any]: ...
    def adversarial_step(self, count: int, draws: torch.Generator) -> dict[str, Any]: ...


class Case(NamedTuple):
    """The two learners and the fields of an iteration."""

    sides: dict[str, Side]
    fields: list[Tensor]


def build(names: tuple[str, ...] = SIDES) -> Case:
    """Learners by name, from the same seed."""
    hierarchy = build_hierarchy(CELLS, DEPTH)
    operator = vertex_operator(hierarchy.finest)
    ours = Learner(MODEL, TRAINING, hierarchy, operator, seed=0, device=torch.device("cpu"))
    sides: dict[str, Side] = {}
    if "naive" in names:
        sides["naive"] = NaiveLearner(ours, hierarchy, operator)
    if "ours" in names:
        sides["ours"] = ours
    return Case(sides, made_up_fields(hierarchy, 1 + TRAINING.critic_steps))


def made_up_fields(hierarchy: GridHierarchy, batches: int) -> list[Tensor]:
    """Batches of balls: their occupancy, and how far away their surface is."""
    draws = torch.Generator().manual_seed(0)
    points = torch.from_numpy(hierarchy.finest.centroids).float()
    fields = []
    for _ in range(batches):
        centers = 0.3 + 0.4 * torch.rand(BATCH, 1, 3, generator=draws)
        radii = 0.1 + 0.2 * torch.rand(BATCH, 1, 1, generator=draws)
        away = points - centers
        distance = away.norm(dim=-1, keepdim=True)
        displacement = (radii - distance) * away / distance
        fields.append(torch.cat([(distance < radii).float(), displacement.clamp(-1, 1)], dim=-1))
    return fields


def iterate(side: Side, fields: list[Tensor], number: int) -> dict[str, float]:
    """One iteration; losses by step and name."""
    steps = [side.autoencoder_step(fields[0], 0.5, step_draws(number, 0))]
    steps += [side.critic_step(field, step_draws(number, 1 + i)) for i, field in enumerate(fields[1:])]
    steps.append(side.adversarial_step(BATCH, step_draws(number, 1 + len(fields))))
    return {f"{i} {name}": float(value) for i, losses in enumerate(steps) for name, value in losses.items()}


def compare_times(repeats: int) -> dict[str, float]:
    """Seconds of an iteration, the best of several taken in turn, after one that shows equal losses."""
    case = build()
    losses = {name: iterate(side, case.fields, 0) for name, side in case.sides.items()}
    for name, expected in losses["naive"].items():
        difference = abs(losses["ours"][name] - expected)
        if difference > TOLERANCE * max(abs(expected), 0.01):
            raise AssertionError(f"{name}: {losses['ours'][name]} is not the {expected} of the naive step")
    seconds = dict.fromkeys(SIDES, float("inf"))
    for number in range(1, repeats + 1):
        for name, side in case.sides.items():
            start = time.perf_counter()
            iterate(side, case.fields, number)
            seconds[name] = min(seconds[name], time.perf_counter() - start)
    return seconds


def peak_of(name: str, threads: int) -> int:
    """Bytes that two iterations take more than the process had, measured in a process of its own."""
    command = [sys.executable, __file__, "--peak", name, "--threads", str(threads)]
    return int(json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout))


def measure_peak(name: str) -> int:
    if name == "ours":
        keep_freed_memory()  # as the command does
    case = build((name,))
    before = _status("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")  # the peak starts anew
    for number in range(2):
        iterate(case.sides[name], case.fields, number)
    return _status("VmHWM") - before


def _status(key: str) -> int:
    """Bytes of a line of Linux's account of this process."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(f"{key}:"))


def run(quick: bool) -> dict[str, dict[str, Any]]:
    """The benchmark's numbers by name, for `make bench`."""
    keep_freed_memory()
    threads = torch.get_num_threads()
    seconds = compare_times(2 if quick else 6)
    peaks = {name: peak_of(name, threads) for name in SIDES}
    device = f"{_processor()}, {threads} threads"

    def entry(value: float, unit: str, target: float | None, better: str) -> dict[str, Any]:
        return {"value": value, "unit": unit, "target": target, "better": better, "device": device}

    return {
        "step: speed against naive": entry(seconds["naive"] / seconds["ours"], "×", 3.0, "higher"),
        "step: memory against naive": entry(peaks["ours"] / peaks["naive"], "×", 0.5, "lower"),
        "step: time": entry(seconds["ours"], "s", None, "lower"),
        "step: memory": entry(peaks["ours"] / 2**20, "MiB", None, "lower"),
    }


def _processor() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), "CPU")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--threads", type=int, default=torch.get_num_threads())
    parser.add_argument("--quick", action="store_true", help="two timed iterations in place of six")
    parser.add_argument("--peak", choices=SIDES, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    torch.set_num_threads(chosen.threads)
    if chosen.peak:
        print(json.dumps(measure_peak(chosen.peak)))
        return
    for name, entry in run(chosen.quick).items():
        target = "" if entry["target"] is None else f"   target {entry['target']}"
        print(f"{name:28} {entry['value']:8.2f} {entry['unit']}{target}")


if __name__ == "__main__":
    main()
