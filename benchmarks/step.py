"""Time and memory of a training iteration beside the plain one of `naive_step`, at equal losses.

python benchmarks/step.py --threads 2

An iteration is an autoencoder step, three critic steps and a step against the critics, on 9,216 tets (cells
2, depth 2) in batches of 4. Widths 16/16/4: 16 channels at the finest level of autoencoder and global critic,
4 in the local critic's first convolution; codes of 64 a coarse tet, as wide as the coarsest level. Both sides
begin with the same weights, and get the same fields and random numbers. Each side runs in a
process of its own, in turn: time is the best iteration, memory what the process takes more at its peak than
before its first iteration, gradients and moments of Adam included. Ours keeps freed memory, as the command
does; the plain one leaves that to the C library, as PyTorch does.
"""

import json
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

from tetgan.fields.field import vertex_operator
from tetgan.grids.hierarchy import GridHierarchy, build_hierarchy
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.nn.device import keep_freed_memory
from tetgan.training.loop import step_draws

CELLS, DEPTH, BATCH = 2, 2, 4
MODEL = TetganOptions.parse(
    {
        **{"grid": "LR", "latent": "tet", "code": 64, "width": 16},
        **{"local_critic_width": 4, "global_critic_width": 16},
    }
)
TRAINING = TetganTraining(batch_size=BATCH, device="cpu")
# Of each loss, or of 0.01 where one is smaller: gaps are differences of means. A penalty measures a gradient,
# which may pass another way through max pooling where two features are equal but for rounding.
TOLERANCE, PENALTY_TOLERANCE, MOVED_TOLERANCE = 1e-4, 1e-3, 1e-2
SIDES = "naive", "ours"


class Side(Protocol):
    """What both learners can do."""

    optimizer: torch.optim.Adam
    critic_optimizer: torch.optim.Adam
    adversarial_optimizer: torch.optim.Adam

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
    ours = TetganLearner(MODEL, TRAINING, hierarchy, operator, mu=0.02, seed=0, device=torch.device("cpu"))
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


def check_losses() -> None:
    """Equal losses of both sides, first with weights that stay, then with weights that move."""
    case = build()
    _assert_equal(case, TOLERANCE, rate=0.0)
    _assert_equal(case, MOVED_TOLERANCE, rate=TRAINING.learning_rate)


def _assert_equal(case: Case, tolerance: float, rate: float) -> None:
    """One iteration of both, whose steps move the weights at this rate, with losses that agree."""
    losses = {}
    for name, side in case.sides.items():
        for optimizer in (side.optimizer, side.critic_optimizer, side.adversarial_optimizer):
            optimizer.param_groups[0]["lr"] = rate
        losses[name] = iterate(side, case.fields, 0)
    for name, expected in losses["naive"].items():
        difference = abs(losses["ours"][name] - expected) / max(abs(expected), 0.01)
        if difference > (max(tolerance, PENALTY_TOLERANCE) if "penalty" in name else tolerance):
            raise AssertionError(f"{name}: {losses['ours'][name]} in place of {expected} at rate {rate}")


class Cost(NamedTuple):
    """Of an iteration."""

    seconds: float
    bytes: int


def compare_costs(rounds: int) -> dict[str, Cost]:
    """The least of several processes of each side, in turn."""
    found: dict[str, list[Cost]] = {name: [] for name in SIDES}
    for _ in range(rounds):
        for name in SIDES:
            command = [sys.executable, __file__, "--side", name, "--threads", str(torch.get_num_threads())]
            answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            found[name].append(Cost(**json.loads(answer)))
    return {name: Cost(*map(min, zip(*costs, strict=True))) for name, costs in found.items()}


def measure(name: str) -> Cost:
    """One side in this process: the best of three iterations, and the peak of them all."""
    if name == "ours":
        keep_freed_memory()
    case = build((name,))
    before = _status("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")  # the peak starts anew
    seconds = []
    for number in range(3):
        start = time.perf_counter()
        iterate(case.sides[name], case.fields, number)
        seconds.append(time.perf_counter() - start)
    return Cost(min(seconds), _status("VmHWM") - before)


def _status(key: str) -> int:
    """Bytes of a line of Linux's account of this process."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(f"{key}:"))


def run(quick: bool) -> Records:
    """Ratios to the naive iteration, and our own time and memory."""
    check_losses()
    naive, ours = compare_costs(1 if quick else 3).values()
    return {
        "step, naive / ours": record(naive.seconds / ours.seconds, "times", 3.0, "higher"),
        "step, memory, ours / naive": record(ours.bytes / naive.bytes, "times", 0.5),
        "step": record(ours.seconds, "s"),
        "step, memory": record(ours.bytes / 2**20, "MiB"),
    }


def main(
    threads: Annotated[int, typer.Option(min=1, help="processor cores to use")] = 2,
    quick: Annotated[bool, typer.Option(help="one process of each side in place of three")] = False,
    side: Annotated[str, typer.Option(hidden=True)] = "",
) -> None:
    """Print the ratios."""
    torch.set_num_threads(threads)
    if side:
        typer.echo(json.dumps(measure(side)._asdict()))
        return
    for name, found in run(quick).items():
        target = "" if found["target"] is None else f"   target {found['target']}"
        typer.echo(f"{name:28} {found['value']:8.2f} {found['unit']}{target}")


if __name__ == "__main__":
    typer.run(main)
