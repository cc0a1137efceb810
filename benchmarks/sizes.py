"""Cost of the tetrahedral convolution against tets, channels and batch."""

import torch
from records import Records, record, wall_seconds

from tetgan.grids.hierarchy import build_hierarchy
from tetgan.nn.conv import SLOTS, TetNeighbors, tet_conv

_GRID = (2, 2)  # cells and depth where they do not vary
_GRIDS = ((1, 2), (2, 2), (3, 2), (2, 3), (3, 3))
_CHANNELS = (4, 8, 16, 32, 64)
_BATCHES = (1, 2, 4, 8, 16)


def run(quick: bool) -> Records:
    """Forward and forward with backward; one size varies at a time."""
    found: Records = {}
    for grid in _GRIDS[:2] if quick else _GRIDS:
        found |= _measure("tets", grid, channels=16, batch=4)
    for channels in _CHANNELS[:2] if quick else _CHANNELS:
        found |= _measure("channels", _GRID, channels=channels, batch=4)
    for batch in _BATCHES[:2] if quick else _BATCHES:
        found |= _measure("batch", _GRID, channels=16, batch=batch)
    return found


def _measure(against: str, grid: tuple[int, int], channels: int, batch: int) -> Records:
    """Two points of the curves whose size is named."""
    neighbors = build_hierarchy(*grid).finest.neighbors
    maps = TetNeighbors(neighbors)
    x = torch.randn(len(neighbors), batch, channels, requires_grad=True)
    weight = torch.randn(SLOTS, channels, channels, requires_grad=True)
    sizes = {"tets": len(neighbors), "channels": channels, "batch": batch}
    fixed = ", ".join(f"{size:,} {name}" for name, size in sizes.items() if name != against)
    place = f"{fixed} [{against}={sizes[against]}]"

    def forward() -> torch.Tensor:
        with torch.no_grad():
            return tet_conv(x, weight, None, maps)

    def both() -> tuple[torch.Tensor, ...]:
        return torch.autograd.grad(tet_conv(x, weight, None, maps).sum(), [x, weight])

    forward()  # the first run of a kernel sets it up
    both()
    return {
        f"convolution, {place}": record(wall_seconds(forward, 5)[0], "s"),
        f"convolution and backward, {place}": record(wall_seconds(both, 5)[0], "s"),
    }


if __name__ == "__main__":
    print(run(quick=False))
