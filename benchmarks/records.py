"""Record of a benchmark: value, unit, target, and the machine it was measured on."""

import os
import platform
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, Literal, TypedDict, TypeVar

R = TypeVar("R")


class Record(TypedDict):
    """One figure; `target` is None where there is nothing to reach."""

    value: float
    unit: str
    target: float | None
    better: Literal["higher", "lower"]
    device: str


Records = dict[str, Record]
"""By name. Figures whose names differ only in a number, as in `grid [tets=9216]`, are a curve."""


def record(
    value: float,
    unit: str,
    target: float | None = None,
    better: Literal["higher", "lower"] = "lower",
    device: str | None = None,
) -> Record:
    """A figure of this machine's processor, unless a device is named."""
    return Record(value=float(value), unit=unit, target=target, better=better, device=device or cpu_name())


def is_met(found: Record) -> bool | None:
    """Whether a figure reaches its target; None where it has none."""
    if found["target"] is None:
        return None
    if found["better"] == "higher":
        return found["value"] >= found["target"]
    return found["value"] <= found["target"]


def cpu_name() -> str:
    """Model of the processor, and how many cores this process may use."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"{_cpu_model()}, {cores} cores"


def _cpu_model() -> str:
    listing = Path("/proc/cpuinfo")
    lines = listing.read_text().splitlines() if listing.is_file() else []
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(models, "") or platform.processor() or platform.machine()


def cpu_seconds(work: Callable[[], R], repeats: int = 1) -> tuple[float, R]:
    """Processor time over all threads, the least of several runs, and what the last run gave."""
    return _fastest(work, repeats, process_time)


def wall_seconds(work: Callable[[], R], repeats: int = 1) -> tuple[float, R]:
    """The same by the clock on the wall."""
    return _fastest(work, repeats, perf_counter)


def _fastest(work: Callable[[], Any], repeats: int, clock: Callable[[], float]) -> tuple[float, Any]:
    best, result = float("inf"), None
    for _ in range(repeats):
        start = clock()
        result = work()
        best = min(best, clock() - start)
    return best, result
