"""A whole iteration of training against the plain one of `naive_step`: same losses, time and memory.

python benchmarks/step.py --threads 2

An iteration is an autoencoder step, three critic steps and a step against the critics, on 9,216 tets (cells
2, depth 2) in batches of 4. Widths 16/16/4: 16 channels at the finest level of autoencoder and global critic,
4 in the local critic's first convolution; codes of 64 a coarse tet, as wide as the coarsest level. Both sides
begin with the same weights, and get the same fields and random numbers. Times are taken in turn in one
process; memory is what a process of its own takes more at its peak than before its first iteration, gradients
and moments of Adam included.
"""

import subprocess
import sys
import time
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Protocol

import torch
import typer
from naive_step import NaiveLearner
from records import Records, record
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
# Of each loss, or of 0.01 where one is smaller: gaps are differences of means. Once weights have moved, the
# gradient that the penalty measures may pass another way through max pooling, so that rounding shows more.
TOLERANCE, MOVED_TOLERANCE = 1e-4, 1e-2
SIDES = "naive", "ours"


class Side(Protocol):
    """What both learners can do."""

    optimizer: torch.optim.Adam
    critic_optimizer: torch.optim.Adam

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
    """Seconds of an iteration, the best of several taken in turn, after one each that shows equal losses."""
    case = build()
    _assert_equal(case, TOLERANCE, rate=0.0)
    _assert_equal(case, MOVED_TOLERANCE, rate=TRAINING.learning_rate)
    seconds = dict.fromkeys(SIDES, float("inf"))
    for number in range(repeats):
        for name, side in case.sides.items():
            start = time.perf_counter()
            iterate(side, case.fields, number)
            seconds[name] = min(seconds[name], time.perf_counter() - start)
    return seconds


def _assert_equal(case: Case, tolerance: float, rate: float) -> None:
    """One iteration of both, whose steps move the weights at this rate, with losses that agree."""
    losses = {}
    for name, side in case.sides.items():
        for optimizer in (side.optimizer, side.critic_optimizer):
            optimizer.param_groups[0]["lr"] = rate
        losses[name] = iterate(side, case.fields, 0)
    for name, expected in losses["naive"].items():
        difference = abs(losses["ours"][name] - expected) / max(abs(expected), 0.01)
        if difference > tolerance:
            raise AssertionError(f"{name}: {losses['ours'][name]} in place of {expected} at rate {rate}")


def peak_of(name: str, threads: int) -> int:
    """Bytes that two iterations take more than the process had, measured in a process of its own."""
    command = [sys.executable, __file__, "--peak", name, "--threads", str(threads)]
    return int(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


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


def run(quick: bool) -> Records:
    """Ratios to the naive iteration, and our own time and memory."""
    keep_freed_memory()
    seconds = compare_times(2 if quick else 6)
    peaks = {name: peak_of(name, torch.get_num_threads()) for name in SIDES}
    return {
        "step, naive / ours": record(seconds["naive"] / seconds["ours"], "times", 3.0, "higher"),
        "step, memory, ours / naive": record(peaks["ours"] / peaks["naive"], "times", 0.5),
        "step": record(seconds["ours"], "s"),
        "step, memory": record(peaks["ours"] / 2**20, "MiB"),
    }


def main(
    threads: Annotated[int, typer.Option(min=1, help="processor cores to use")] = 2,
    quick: Annotated[bool, typer.Option(help="two timed iterations in place of six")] = False,
    peak: Annotated[str, typer.Option(hidden=True)] = "",
) -> None:
    """Print the ratios."""
    torch.set_num_threads(threads)
    if peak:
        typer.echo(measure_peak(peak))
        return
    for name, found in run(quick).items():
        target = "" if found["target"] is None else f"   target {found['target']}"
        typer.echo(f"{name:28} {found['value']:8.2f} {found['unit']}{target}")


if __name__ == "__main__":
    typer.run(main)
