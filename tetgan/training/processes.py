"""Several processes that train one model, each on its share of every batch (`torchrun` starts them).

A batch is cut into as many parts as there are processes, times the parts that each takes in turn. Every
process draws the random numbers of the whole batch and keeps its own, so that the losses of a step do not
depend on how it was cut, but for rounding.
"""

import logging
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise

import torch
from torch import Tensor, distributed, nn
from torch.nn.parallel import DistributedDataParallel

from tetgan.nn.device import pick_device


@dataclass(frozen=True)
class Share:
    """Some rows of a batch.

    Attributes:
        rows: their places in the batch.
        own: the same, counted from the first row that is this process's.
        weight: of their mean in a mean over the shares of a process, then over processes.
    """

    rows: slice
    own: slice
    weight: float


def launched_together() -> int:
    """Number of processes that `torchrun` started of this command; 1 without it."""
    return int(os.environ.get("WORLD_SIZE", "1"))


def process_count() -> int:
    """Number of processes that train together."""
    return distributed.get_world_size() if distributed.is_initialized() else 1


def process_place() -> int:
    """Number of this process, from 0. The first alone writes: checkpoints, log, pictures, model."""
    return distributed.get_rank() if distributed.is_initialized() else 0


def shares(rows: int, parts: int) -> list[Share]:
    """Shares of a batch that this process takes, in at most `parts` parts, as equal as can be.

    With more processes than rows some would have none; they take the first, with no weight, as every process
    must take part in a step.
    """
    processes, place = process_count(), process_place()
    cuts = [rows * cut // (processes * parts) for cut in range(place * parts, (place + 1) * parts + 1)]
    if cuts[0] == cuts[-1]:
        return [Share(slice(0, 1), slice(0, 1), 0.0)]
    return [
        Share(slice(start, stop), slice(start - cuts[0], stop - cuts[0]), (stop - start) * processes / rows)
        for start, stop in pairwise(cuts)
        if start < stop
    ]


def own_rows(rows: int) -> slice:
    """The rows of a batch that this process reads."""
    return shares(rows, 1)[0].rows


def own_device(device: str) -> torch.device:
    """The device of this process; each of several has a GPU of its own."""
    chosen = pick_device(device)
    if chosen.type == "cuda" and launched_together() > 1:
        return torch.device("cuda", int(os.environ["LOCAL_RANK"]))
    return chosen


@contextmanager
def process_group(device: str) -> Iterator[None]:
    """Inside, the processes that `torchrun` started, if it did, are joined. All but the first keep quiet."""
    if launched_together() == 1:
        yield
        return
    chosen = own_device(device)
    if chosen.type == "cuda":
        torch.cuda.set_device(chosen)
    distributed.init_process_group("nccl" if chosen.type == "cuda" else "gloo")
    if process_place() > 0:
        logging.disable(logging.WARNING)
    try:
        yield
    finally:
        logging.disable(logging.NOTSET)
        distributed.destroy_process_group()


def joined(module: nn.Module) -> nn.Module:
    """The module, in DistributedDataParallel where there are several processes.

    Each kind of step leaves other parameters out, which that class has to look for.
    """
    if process_count() == 1:
        return module
    return DistributedDataParallel(module, find_unused_parameters=True, forward_sync_buffers=False)


@contextmanager
def exchanging(module: nn.Module, wanted: bool) -> Iterator[None]:
    """Whether the backward pass inside averages gradients over processes; if not, they add up here."""
    if wanted or not isinstance(module, DistributedDataParallel):
        yield
    else:
        with module.no_sync():
            yield


def mean_over_processes(values: Mapping[str, Tensor]) -> dict[str, float | Tensor]:
    """Means of numbers that each process has by the same names."""
    if process_count() == 1:
        return {**values}
    together = torch.stack(list(values.values()))
    distributed.all_reduce(together)
    return {**dict(zip(values, together / process_count(), strict=True))}


@torch.no_grad()
def as_in_first(module: nn.Module) -> None:
    """Give every process the weights of the first, after each computed them for itself."""
    if process_count() > 1:
        for value in module.state_dict().values():
            distributed.broadcast(value, 0)


def relaunch(processes: int) -> None:
    """Replace this command by several of it, started by `torchrun`; nothing to do for one, or inside one."""
    if processes <= 1 or launched_together() > 1:
        return
    launcher = [
        sys.executable,
        "-m",
        "torch.distributed.run",
        "--standalone",
        f"--nproc-per-node={processes}",
    ]
    os.execv(sys.executable, [*launcher, "-m", "tetgan", *sys.argv[1:]])
