"""Time of the tetrahedral convolution beside its plain form: `python -m benchmarks.conv`.

On a CPU each run is a process of its own, so that what ran before decides nothing. Freed memory goes back to
the kernel, as PyTorch leaves it, and the plain form pays for the pages of its large buffers each time. The
commands keep it (tetgan/nn/device.py): the ratios with memory kept on both sides are beside.
"""

import json
import subprocess
import sys
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from statistics import geometric_mean, median
from time import perf_counter
from typing import Annotated, Any

import torch
import typer
from torch import Tensor

from benchmarks.naive import around, linear_form, naive_tet_conv
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.nn.conv import SLOTS, TetNeighbors, conv_backend, input_gradients_only, tet_conv
from tetgan.nn.device import keep_freed_memory

Result = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """A convolution: widths, batch, and the depth of a grid of two cells a side."""

    channels: int
    out: int
    batch: int
    depth: int

    @property
    def name(self) -> str:
        return f"{self.channels}-{self.out}-batch{self.batch}-depth{self.depth}"


CASES = (Case(64, 64, 1, 3), Case(16, 16, 8, 2), Case(32, 32, 8, 2), Case(4, 64, 1, 3), Case(64, 4, 1, 3))
CPU = torch.device("cpu")
GPU_CASE = Case(64, 64, 30, 3)
CPU_TARGETS = {"forward": 3.5, "backward": 3.0, "penalty": 3.0}
GPU_TARGETS = {"forward": 4.0, "backward": None, "penalty": 3.0}
MEMORY_TARGETS = {"forward": 1 / 4, "backward": 1 / 3}


@dataclass(frozen=True)
class Side:
    """One way to convolve, with its inputs in the layout it likes."""

    conv: Callable[..., Tensor]
    inputs: tuple[Tensor, ...]
    cotangent: Tensor

    def forward(self) -> Tensor:
        with torch.no_grad():
            return self.conv(*self.inputs)

    def backward(self) -> tuple[Tensor, ...]:
        return torch.autograd.grad(self.conv(*self.inputs), self.inputs, self.cotangent.detach())

    def penalty(self) -> tuple[Tensor, ...]:
        """Derivatives of <y, g> + <∂<y, g>/∂x, x> by x, W, b and g, as a gradient penalty takes them."""
        y = self.conv(*self.inputs)
        with input_gradients_only():
            (dx,) = torch.autograd.grad(y, self.inputs[0], self.cotangent, create_graph=True)
        directions = self.cotangent.detach(), self.inputs[0].detach()
        return torch.autograd.grad((y, dx), (*self.inputs, self.cotangent), directions)


def run(quick: bool, device: torch.device | None = None) -> dict[str, Result]:
    """Ratios of naive to our time for each case and pass and their geometric means, and what a GPU has."""
    device = device or torch.device("cuda" if torch.cuda.is_available() else "cpu")
    on_gpu = run_gpu(5 if quick else 21, device) if device.type == "cuda" else {}
    kept = run_in_a_process(quick, "--keep-memory")
    means = {f"{name}, memory kept": each for name, each in kept.items() if name.endswith("mean_ratio")}
    means = {name: {**each, "target": None} for name, each in means.items()}
    return on_gpu | run_in_a_process(quick) | means


def run_in_a_process(quick: bool, *options: str) -> dict[str, Result]:
    """What `run_cpu` finds in a fresh process."""
    command = [sys.executable, "-m", "benchmarks.conv", "--json", f"--threads={torch.get_num_threads()}"]
    command += ["--device=cpu", *options, *(["--quick"] if quick else [])]
    root = Path(__file__).parent.parent
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, cwd=root).stdout)


def run_cpu(repeats: int) -> dict[str, Result]:
    """Ratios of naive to our time for each case and pass, and their geometric means."""
    results: dict[str, Result] = {}
    for name, target in CPU_TARGETS.items():
        ratios = {}
        for case in CASES:
            naive, ours = build_sides(case, CPU, torch.float32)
            plain, fast = interleaved(naive, ours, name, repeats)
            ratios[case.name] = plain / fast
            results[f"conv.{name}.{case.name}.ms"] = result(1e3 * fast, "ms", None, "lower", CPU)
        for case_name, ratio in ratios.items():
            results[f"conv.{name}.{case_name}.ratio"] = result(ratio, "times", None, "higher", CPU)
        mean = geometric_mean(ratios.values())
        results[f"conv.{name}.mean_ratio"] = result(mean, "times", target, "higher", CPU)
    return results


def run_gpu(repeats: int, device: torch.device) -> dict[str, Result]:
    """Ratios in bfloat16, the share of the roofline, and memory above the inputs beside the naive form."""
    naive, ours = build_sides(GPU_CASE, device, torch.bfloat16)
    results: dict[str, Result] = {}
    for name, target in GPU_TARGETS.items():
        plain, fast = interleaved(naive, ours, name, repeats)
        results[f"conv.{name}.ms"] = result(1e3 * fast, "ms", None, "lower", device)
        results[f"conv.{name}.ratio"] = result(plain / fast, "times", target, "higher", device)
        if name == "forward":
            share = roofline_seconds(GPU_CASE, ours, device) / fast
            results["conv.forward.roofline"] = result(share, "share", 0.4, "higher", device)
    for name, target in MEMORY_TARGETS.items():
        share = peak_bytes(getattr(ours, name)) / peak_bytes(getattr(naive, name))
        results[f"conv.{name}.memory"] = result(share, "share of naive", target, "lower", device)
    return results


def build_sides(case: Case, device: torch.device, dtype: torch.dtype) -> tuple[Side, Side]:
    """The naive form and ours on the same numbers; they must agree before they are timed."""
    neighbors = build_hierarchy(2, case.depth).finest.neighbors
    generator = torch.Generator().manual_seed(0)

    def draw(*shape: int) -> Tensor:
        return torch.randn(*shape, generator=generator).to(device, dtype)

    x, bias = draw(len(neighbors), case.batch, case.channels), draw(case.out)
    weight, cotangent = draw(SLOTS, case.channels, case.out), draw(len(neighbors), case.batch, case.out)
    weight /= (SLOTS * case.channels) ** 0.5
    maps, index = TetNeighbors(neighbors).to(device), around(neighbors).to(device)
    shapes_first = [tensor.transpose(0, 1).contiguous() for tensor in (x, cotangent)]
    naive_inputs = (shapes_first[0], linear_form(weight), bias)
    naive = Side(lambda *inputs: naive_tet_conv(*inputs, index), *with_grad(naive_inputs, shapes_first[1]))
    ours = Side(lambda *inputs: tet_conv(*inputs, maps), *with_grad((x, weight, bias), cotangent))
    tolerance = 1e-4 if dtype == torch.float32 else 0.1
    torch.testing.assert_close(
        ours.forward(), naive.forward().transpose(0, 1), rtol=tolerance, atol=tolerance
    )
    return naive, ours


def with_grad(inputs: tuple[Tensor, ...], cotangent: Tensor) -> tuple[tuple[Tensor, ...], Tensor]:
    """Leaves that gradients are taken by."""
    return tuple(tensor.clone().requires_grad_() for tensor in inputs), cotangent.clone().requires_grad_()


def interleaved(naive: Side, ours: Side, name: str, repeats: int) -> tuple[float, float]:
    """Median seconds of each, taken in turns so that both meet the same machine."""
    works = [getattr(side, name) for side in (naive, ours)]
    times = [[seconds(work) for work in works] for _ in range(repeats + 1)][1:]
    plain, fast = (median(column) for column in zip(*times, strict=True))
    return plain, fast


def seconds(work: Callable[[], object]) -> float:
    """Wall time of one run, the GPU's work included."""
    synchronize()
    start = perf_counter()
    work()
    synchronize()
    return perf_counter() - start


def synchronize() -> None:
    """Wait for the GPU, if there is one."""
    if torch.cuda.is_available():
        torch.cuda.synchronize()


def roofline_seconds(case: Case, ours: Side, device: torch.device) -> float:
    """The larger of moving two rows a tet with its indices and of the arithmetic, at measured rates."""
    tets, rows = len(ours.cotangent), len(ours.cotangent) * case.batch
    row_bytes = ours.cotangent.element_size() * (case.channels + case.out)
    traffic = rows * row_bytes + tets * 4 * (SLOTS - 1)
    flop = 2 * SLOTS * case.channels * case.out * rows
    source = torch.empty(1 << 30, dtype=torch.uint8, device=device)
    target = torch.empty_like(source)
    factor = torch.randn(8192, 8192, device=device, dtype=torch.bfloat16)
    copy = 2 * len(source) / typical(lambda: target.copy_(source))
    product = 2 * len(factor) ** 3 / typical(lambda: factor @ factor)
    return max(traffic / copy, flop / product)


def typical(work: Callable[[], object]) -> float:
    """Median seconds of eleven runs, after one to warm up."""
    return median([seconds(work) for _ in range(12)][1:])


def peak_bytes(work: Callable[[], object]) -> int:
    """Memory that a run takes at most, above what was there."""
    torch.cuda.reset_peak_memory_stats()
    before = torch.cuda.memory_allocated()
    work()
    return torch.cuda.max_memory_allocated() - before


def result(value: float, unit: str, target: float | None, better: str, device: torch.device) -> Result:
    """One entry of the table of benchmarks."""
    name = torch.cuda.get_device_name(device) if device.type == "cuda" else "cpu"
    return {"value": value, "unit": unit, "target": target, "better": better, "device": name}


def main(
    *,
    quick: Annotated[bool, typer.Option(help="Three repeats instead of eleven.")] = False,
    threads: Annotated[int, typer.Option(help="Threads of torch.")] = 2,
    device: Annotated[str, typer.Option(help="cpu or cuda; left out, CUDA where there is one.")] = "",
    backend: Annotated[str, typer.Option(help="Force reference, cpu or triton.")] = "",
    keep_memory: Annotated[bool, typer.Option(help="Both sides keep freed memory.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Naive and our seconds of a forward, a backward and a gradient-penalty pass."""
    torch.set_num_threads(threads)
    if keep_memory:
        keep_freed_memory()
    chosen = torch.device(device or ("cuda" if torch.cuda.is_available() else "cpu"))
    with conv_backend(backend) if backend else nullcontext():
        results = (
            run_gpu(5 if quick else 21, chosen) if chosen.type == "cuda" else run_cpu(3 if quick else 11)
        )
    if as_json:
        typer.echo(json.dumps(results))
        return
    for name, entry in results.items():
        target = "" if entry["target"] is None else f"  (target {entry['target']:.2f})"
        typer.echo(f"{name:48s}{entry['value']:9.2f} {entry['unit']}{target}")


if __name__ == "__main__":
    typer.run(main)
