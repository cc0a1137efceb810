"""Time of the tetrahedral convolution, forward and backward, against gathering five columns for one product.

python benchmarks/conv.py --threads 2 --cells 2 --depth 2 --batch 8 --channels 16 32
"""

import argparse
import time
from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from tetgan.grids.hierarchy import build_hierarchy
from tetgan.nn.conv import SLOTS, TetNeighbors, tet_conv


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--threads", type=int, default=torch.get_num_threads())
    parser.add_argument("--cells", type=int, default=2)
    parser.add_argument("--depth", type=int, default=2)
    parser.add_argument("--batch", type=int, default=8)
    parser.add_argument("--channels", type=int, nargs="+", default=[16, 32])
    parser.add_argument("--device", default="cpu")
    chosen = parser.parse_args()
    torch.set_num_threads(chosen.threads)
    neighbors = build_hierarchy(chosen.cells, chosen.depth).finest.neighbors
    print(f"{len(neighbors):,} tets, batch {chosen.batch}, {chosen.threads} threads, {chosen.device}")
    print("channels   forward naive/ours (ms)   forward+backward naive/ours (ms)   ours (GFLOP/s)")
    for channels in chosen.channels:
        print(compare(neighbors, chosen.batch, channels, torch.device(chosen.device)))


def compare(neighbors: np.ndarray, batch: int, channels: int, device: torch.device) -> str:
    """One row of the table: the best of several runs of each."""
    maps = TetNeighbors(neighbors).to(device)
    x = torch.randn(len(neighbors), batch, channels, device=device, requires_grad=True)
    weight = torch.randn(SLOTS, channels, channels, device=device, requires_grad=True)
    shapes_first = x.detach().transpose(0, 1).contiguous().requires_grad_()
    index = torch.from_numpy(np.where(neighbors < 0, len(neighbors), neighbors)).to(device)
    runs: tuple[tuple[Callable[[], Tensor], Tensor], ...] = (
        (lambda: naive_conv(shapes_first, weight, index), shapes_first),
        (lambda: tet_conv(x, weight, None, maps), x),
    )
    forward = [seconds(run) for run, _ in runs]
    both = [seconds(lambda run=run, x=x: torch.autograd.grad(run().sum(), [x, weight])) for run, x in runs]
    rate = 2 * SLOTS * channels**2 * len(neighbors) * batch / forward[1] / 1e9
    ms = [1e3 * value for value in (*forward, *both)]
    return f"{channels:8}   {ms[0]:11.1f} / {ms[1]:.1f} {ms[2]:22.1f} / {ms[3]:.1f} {rate:24.0f}"


def naive_conv(x: Tensor, weight: Tensor, index: Tensor) -> Tensor:
    """(B, T, C): neighbors gathered beside each tet, (B, T, 5C), then one product."""
    padded = torch.cat([x, x.new_zeros(len(x), 1, x.shape[2])], dim=1)
    columns = torch.cat([x[:, :, None], padded[:, index]], dim=2).flatten(2)
    return columns @ weight.flatten(0, 1)


def seconds(run: Callable[[], object], repeats: int = 10) -> float:
    """The fastest of several runs, after one to warm up."""
    best = float("inf")
    for _ in range(repeats + 1):
        synchronize()
        start = time.perf_counter()
        run()
        synchronize()
        best = min(best, time.perf_counter() - start)
    return best


def synchronize() -> None:
    """Wait for the GPU, if there is one."""
    if torch.cuda.is_available():
        torch.cuda.synchronize()


if __name__ == "__main__":
    main()
