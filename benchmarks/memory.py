"""Memory and time of a training iteration at the paper's sizes, for grids, batches and switches.

python benchmarks/memory.py                     measured on a GPU, with times and bf16, where there is one
python benchmarks/memory.py --device computed   every tensor at its full size, none of it real

An iteration is an autoencoder step, a critic step and a step against the critics, widths 64/64/16, codes of
512: a coarse tet on LR, a shape on HR. Computed memory is the largest sum of bytes of the tensors alive at a
time, weights, gradients and moments of Adam included, where convolutions make nothing but their output;
neither CUDA's own half gigabyte is in it nor what its allocator loses between blocks. Computed time is the
least that a GPU's data sheet allows: every operation reads its inputs and writes its outputs once, unfused
but for the convolutions. GB are 10⁹ bytes.
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

from tetgan.fields.field import vertex_operator
from tetgan.grids.hierarchy import GridHierarchy, build_hierarchy
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.nn import norm
from tetgan.nn.conv import SLOTS
from tetgan.training.loop import step_draws

log = logging.getLogger(__name__)

DEPTH = 3
GRIDS = {"LR": (2, "tet"), "HR": (3, "global")}
CARDS = (80, 24)  # GB
PARTS = (1, 2, 3, 4, 5, 6, 8, 10, 15, 30)
BATCH = 30
WHOLE = f" [batch={BATCH}]"
SWITCHES: dict[str, dict[str, Any]] = {
    " [batch=8]": {"batch_size": 8},
    WHOLE: {"batch_size": BATCH},
    ", checkpointing": {"checkpointing": True},
}
GPU_SWITCHES: dict[str, dict[str, Any]] = {", bf16": {"precision": "bf16"}}
# Dense TF32 products and memory, a second.
DATA_SHEETS = {"an A40": (74.8e12, 0.696e12), "an H100": (494e12, 3.35e12)}


class Cost(NamedTuple):
    """Of an iteration: measured with seconds, computed with what must be multiplied and moved."""

    gigabytes: float
    seconds: float | None = None
    flop: float = 0.0
    traffic: float = 0.0


class LiveBytes(TorchDispatchMode):
    """Counts the bytes of every storage that operations make, until it is freed, and the bytes they touch."""

    def __init__(self) -> None:
        super().__init__()
        self.now = self.peak = self.traffic = 0
        self._known = weakref.WeakSet[torch.UntypedStorage]()

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        result = func(*args, **(kwargs or {}))
        read, made = _tensors((args, kwargs)), _tensors(result)
        read_from = {tensor.untyped_storage()._cdata for tensor in read}
        if func._schema.is_mutable or any(t.untyped_storage()._cdata not in read_from for t in made):
            self.traffic += sum(tensor.numel() * tensor.element_size() for tensor in (*read, *made))
        for tensor in made:
            self._count(tensor.untyped_storage())
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


def _tensors(tree: Any) -> list[Tensor]:
    return [leaf for leaf in tree_leaves(tree) if isinstance(leaf, Tensor)]


class Outputs:
    """What a fused convolution allocates, and how much it multiplies."""

    def __init__(self) -> None:
        self.flop = 0.0

    def conv(self, x: Tensor, weight: Tensor, *_: Any) -> Tensor:
        return self._product(x, *x.shape[:2], weight.shape[2], by=weight.numel())

    def weight_gradient(self, x: Tensor, grad: Tensor, *_: Any) -> Tensor:
        size = SLOTS, x.shape[2], grad.shape[2]
        return self._product(x, *size, by=SLOTS * x.shape[2] * grad.shape[2])

    def conv_and_weight_gradient(
        self, x: Tensor, weight: Tensor, other: Tensor, *_: Any
    ) -> tuple[Tensor, Tensor]:
        return self.conv(x, weight), self.weight_gradient(x, other)

    def _product(self, x: Tensor, *size: int, by: int) -> Tensor:
        """Product of every tet's and shape's row with `by` weights."""
        self.flop += 2 * x.shape[0] * x.shape[1] * by
        return x.new_empty(*size)


def iteration_cost(
    name: str, hierarchy: GridHierarchy, device: str, width: int = 64, **switches: Any
) -> Cost:
    """Memory and, on a GPU, time of an iteration on a grid; `switches` are training options."""
    training = TetganTraining.parse({"batch_size": BATCH} | switches)
    options = TetganOptions.parse(
        {
            **{"grid": name, "latent": GRIDS[name][1], "code": 8 * width, "width": width},
            **{"local_critic_width": width // 4, "global_critic_width": width},
        }
    )
    with _computed() if device == "computed" else nullcontext() as counted:
        where = torch.device("cpu" if counted else device)
        operator = vertex_operator(hierarchy.finest)
        learner = TetganLearner(options, training, hierarchy, operator, mu=0.02, seed=0, device=where)
        field = torch.rand(training.batch_size, len(hierarchy.finest.tets), 4, device=where)
        field[..., 0].round_()
        if counted:
            live, products = counted
            live.traffic = 0
            _iterate(learner, field, None)
            constants = sum(b.untyped_storage().nbytes() for b in learner.objectives.buffers())
            return Cost((live.peak + constants) / 1e9, None, products.flop, live.traffic)
        return _measured(learner, field)


@contextmanager
def _computed() -> Iterator[tuple[LiveBytes, Outputs]]:
    """Tensors that have a size and no content."""
    products = Outputs()
    outputs = patch("tetgan.nn.conv.kernels", lambda _: products)
    stay = patch.object(torch.nn.Module, "to", lambda module, _: module)  # fake ones cannot be swapped
    chunks = patch.object(norm, "CPU_CHUNK", norm.GPU_CHUNK)
    with outputs, chunks, stay, FakeTensorMode(allow_non_fake_inputs=True), LiveBytes() as live:
        yield live, products


def _measured(learner: TetganLearner, field: Tensor) -> Cost:
    """On a GPU: the second of two iterations."""
    torch.cuda.reset_peak_memory_stats()
    for _ in range(2):
        torch.cuda.synchronize()
        start = time.perf_counter()
        _iterate(learner, field, step_draws(0, 0))
        torch.cuda.synchronize()
    return Cost(torch.cuda.max_memory_allocated() / 1e9, time.perf_counter() - start)


def _iterate(learner: TetganLearner, field: Tensor, draws: Any) -> None:
    learner.autoencoder_step(field, 0.5, draws)
    learner.critic_step(field, draws)
    learner.adversarial_step(len(field), draws)


def fitting_cost(
    name: str, hierarchy: GridHierarchy, device: str, width: int, **switches: Any
) -> Cost | None:
    """`iteration_cost`, or None where the GPU has too little memory."""
    try:
        return iteration_cost(name, hierarchy, device, width, **switches)
    except torch.OutOfMemoryError:
        return None


def fewest_parts(
    name: str, hierarchy: GridHierarchy, card: int, device: str, width: int
) -> tuple[int, Cost | None]:
    """In how few parts a batch of 30 must be computed to fit, and what that costs, if any of `PARTS` fits."""
    for parts in PARTS:
        cost = fitting_cost(name, hierarchy, device, width, accumulate=parts)
        if cost is not None and cost.gigabytes <= card:
            return parts, cost
    return parts, None


def least_seconds(cost: Cost, flop_a_second: float, bytes_a_second: float) -> float:
    """By the roofline: all products at their peak or all tensors through memory, whichever takes longer."""
    return max(cost.flop / flop_a_second, cost.traffic / bytes_a_second)


def run(quick: bool, device: str = "") -> Records:
    """Costs by grid, batch and switches, and the parts that batches need to fit into a card.

    Args:
        device: "computed" or "cuda"; left out, what is here.
    """
    device = device or ("cuda" if torch.cuda.is_available() else "computed")
    depth, width = (1, 8) if quick else (DEPTH, 64)
    rows = SWITCHES if device == "computed" else SWITCHES | GPU_SWITCHES
    found: Records = {}
    for name, (cells, _) in GRIDS.items():
        hierarchy = build_hierarchy(cells, depth)
        for key, switches in rows.items():
            cost = fitting_cost(name, hierarchy, device, width, **switches)
            found |= _records(f"{name}{key}", cost, device, CARDS[0] if key == WHOLE else None)
        for card in CARDS:
            parts, cost = fewest_parts(name, hierarchy, card, device, width)
            found |= _records(f"{name}, accumulated for {card} GB", cost, device, card)
            log.info("%s: %d parts for %d GB", name, parts, card)
    return found


def _records(name: str, cost: Cost | None, device: str, target: float | None) -> Records:
    """Memory, and seconds as measured or, on GPUs by their data sheets, at least."""
    if cost is None:
        log.warning("%s: more than this GPU has", name)
        return {}
    log.info("%s: %.2f GB", name, cost.gigabytes)
    label = device if device == "computed" else torch.cuda.get_device_name()
    found = {f"training memory, {name}": record(cost.gigabytes, "GB", target, "lower", label)}
    if "accumulated" in name:
        return found
    if cost.seconds is not None:
        return found | {f"training time, {name}": record(cost.seconds, "s", None, "lower", label)}
    return found | {
        f"training time at least on {gpu}, {name}": record(
            least_seconds(cost, *rates), "s", None, "lower", label
        )
        for gpu, rates in DATA_SHEETS.items()
    }


def main(
    device: Annotated[str, typer.Option(help="computed, or cuda; left out, CUDA where there is one")] = "",
    quick: Annotated[bool, typer.Option(help="toy sizes, to see that it runs")] = False,
) -> None:
    """Print the costs."""
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    for name, found in run(quick, device).items():
        typer.echo(f"{name:50} {found['value']:8.2f} {found['unit']}   {found['device']}")


if __name__ == "__main__":
    typer.run(main)
