"""Memory and time of a training iteration at the paper's sizes, for grids, batches and switches.

python benchmarks/memory.py                 computed: every tensor at its full size, none of it real
python benchmarks/memory.py --device cuda   measured on a GPU, with times and bf16

An iteration is an autoencoder step, a critic step and a step against the critics, widths 64/64/16, codes of
512: a coarse tet on LR, a shape on HR. Computed memory is the largest sum of bytes of the tensors alive at a
time, weights, gradients and moments of Adam included, where convolutions make nothing but their output;
neither CUDA's own half gigabyte is in it nor what its allocator loses between blocks. GB are 10⁹ bytes.
"""

import logging
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import Annotated, Any, NamedTuple
from unittest.mock import patch

import torch
import typer
from records import Records, record
from torch import Tensor
from torch._subclasses.fake_tensor import FakeTensorMode
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils._pytree import tree_leaves

from tetgan.fields.vertices import vertex_operator
from tetgan.grids.hierarchy import GridHierarchy, build_hierarchy
from tetgan.models.options import TetganOptions
from tetgan.nn import norm
from tetgan.nn.conv import SLOTS
from tetgan.training.learner import Learner
from tetgan.training.loop import step_draws
from tetgan.training.options import TrainingOptions

log = logging.getLogger(__name__)

DEPTH = 3
GRIDS = {"LR": (2, "tet"), "HR": (3, "global")}
CARDS = (80, 24)  # GB
PARTS = (1, 2, 3, 4, 5, 6, 8, 10, 15, 30)
BATCH = 30


class Cost(NamedTuple):
    """Of an iteration."""

    gigabytes: float
    seconds: float | None


class LiveBytes(TorchDispatchMode):
    """Counts the bytes of every storage that operations make, until it is freed."""

    def __init__(self) -> None:
        super().__init__()
        self.now = self.peak = 0
        self._known = weakref.WeakSet[torch.UntypedStorage]()

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        result = func(*args, **(kwargs or {}))
        for leaf in tree_leaves(result):
            if isinstance(leaf, Tensor):
                self._count(leaf.untyped_storage())
        return result

    def _count(self, storage: torch.UntypedStorage) -> None:
        if storage in self._known:
            return
        self._known.add(storage)
        self.now += storage.nbytes()
        self.peak = max(self.peak, self.now)
        weakref.finalize(storage, self._free, storage.nbytes())

    def _free(self, size: int) -> None:
        self.now -= size


class Outputs:
    """What a fused convolution allocates."""

    @staticmethod
    def conv(x: Tensor, weight: Tensor, *_: Any) -> Tensor:
        return x.new_empty(*x.shape[:2], weight.shape[2])

    @staticmethod
    def weight_gradient(x: Tensor, grad: Tensor, *_: Any) -> Tensor:
        return x.new_empty(SLOTS, x.shape[2], grad.shape[2])

    @classmethod
    def conv_and_weight_gradient(
        cls, x: Tensor, weight: Tensor, other: Tensor, *_: Any
    ) -> tuple[Tensor, Tensor]:
        return cls.conv(x, weight), cls.weight_gradient(x, other)


def iteration_cost(
    name: str, hierarchy: GridHierarchy, device: str, width: int = 64, **switches: Any
) -> Cost:
    """Memory and, on a GPU, time of an iteration on a grid; `switches` are training options."""
    training = TrainingOptions.parse({"batch_size": BATCH} | switches)
    options = TetganOptions.parse(
        {
            **{"grid": name, "latent": GRIDS[name][1], "code": 8 * width, "width": width},
            **{"local_critic_width": width // 4, "global_critic_width": width},
        }
    )
    with _computed() if device == "computed" else nullcontext() as live:
        where = torch.device("cpu" if live else device)
        operator = vertex_operator(hierarchy.finest)
        learner = Learner(options, training, hierarchy, operator, seed=0, device=where)
        field = torch.rand(training.batch_size, len(hierarchy.finest.tets), 4, device=where)
        field[..., 0].round_()
        if live:
            _iterate(learner, field, None)
            constants = sum(b.untyped_storage().nbytes() for b in learner.objectives.buffers())
            return Cost((live.peak + constants) / 1e9, None)
        return _measured(learner, field)


@contextmanager
def _computed() -> Iterator[LiveBytes]:
    """Tensors that have a size and no content."""
    outputs = patch("tetgan.nn.conv.kernels", lambda _: Outputs)
    stay = patch.object(torch.nn.Module, "to", lambda module, _: module)  # fake ones cannot be swapped
    chunks = patch.object(norm, "CPU_CHUNK", norm.GPU_CHUNK)
    with outputs, chunks, stay, FakeTensorMode(allow_non_fake_inputs=True), LiveBytes() as live:
        yield live


def _measured(learner: Learner, field: Tensor) -> Cost:
    """On a GPU: the second of two iterations."""
    torch.cuda.reset_peak_memory_stats()
    for _ in range(2):
        torch.cuda.synchronize()
        start = time.perf_counter()
        _iterate(learner, field, step_draws(0, 0))
        torch.cuda.synchronize()
    return Cost(torch.cuda.max_memory_allocated() / 1e9, time.perf_counter() - start)


def _iterate(learner: Learner, field: Tensor, draws: Any) -> None:
    learner.autoencoder_step(field, 0.5, draws)
    learner.critic_step(field, draws)
    learner.adversarial_step(len(field), draws)


def fewest_parts(name: str, hierarchy: GridHierarchy, card: int, device: str, width: int) -> tuple[int, Cost]:
    """In how few parts a batch of 30 must be computed to fit, and what that costs."""
    for parts in PARTS:
        try:
            cost = iteration_cost(name, hierarchy, device, width, accumulate=parts)
        except torch.OutOfMemoryError:
            continue
        if cost.gigabytes <= card:
            break
    return parts, cost


def run(quick: bool, device: str = "computed") -> Records:
    """Costs by grid, batch and switches, and the parts that batches need to fit into a card."""
    depth, width = (1, 8) if quick else (DEPTH, 64)
    label = device if device == "computed" else torch.cuda.get_device_name()
    found: Records = {}
    for name, (cells, _) in GRIDS.items():
        hierarchy = build_hierarchy(cells, depth)

        def note(key: str, cost: Cost, target: float | None = None, name: str = name) -> None:
            log.info("%s%s: %.2f GB", name, key, cost.gigabytes)
            found[f"training memory, {name}{key}"] = record(cost.gigabytes, "GB", target, "lower", label)
            if cost.seconds is not None:
                found[f"training time, {name}{key}"] = record(cost.seconds, "s", None, "lower", label)

        for batch in (8, BATCH):
            target = CARDS[0] if batch == BATCH else None
            note(
                f" [batch={batch}]", iteration_cost(name, hierarchy, device, width, batch_size=batch), target
            )
        note(", checkpointing", iteration_cost(name, hierarchy, device, width, checkpointing=True))
        if device != "computed":
            note(", bf16", iteration_cost(name, hierarchy, device, width, precision="bf16"))
        for card in CARDS:
            parts, cost = fewest_parts(name, hierarchy, card, device, width)
            note(f", in {parts} parts for {card} GB", cost, card)
    return found


def main(
    device: Annotated[str, typer.Option(help="computed, or cuda")] = "computed",
    quick: Annotated[bool, typer.Option(help="toy sizes, to see that it runs")] = False,
) -> None:
    """Print the costs."""
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    for name, found in run(quick, device).items():
        typer.echo(f"{name:50} {found['value']:8.2f} {found['unit']}   {found['device']}")


if __name__ == "__main__":
    typer.run(main)
