"""Which order of gathering and multiplying costs least on a CPU, by a fixed model.

A model rather than a measurement: the methods round differently, and the same machine must give the same
bytes every time. The constants are nanoseconds of one AVX-512 core (docs/kernels.md).
"""

from functools import cache
from typing import Literal

import torch
from torch import Tensor

from tetgan.nn.neighbors import SLOTS

Method = Literal["columns", "accumulate", "first"]

CHUNK_BYTES = 1 << 20  # gathered rows of a chunk, a thread: about a core's own cache
_FEWEST = 64  # tets in a chunk; fewer would be all overhead
_NUMBER = 4  # bytes


def chunk_size(x: Tensor) -> int:
    """Tets to take at a time: a power of two, so that few tables are kept; all of them off the CPU."""
    if x.device.type != "cpu":
        return max(len(x), 1)
    fit = CHUNK_BYTES * torch.get_num_threads() // ((SLOTS - 1) * x[0].numel() * x.element_size())
    return 1 << max(fit, _FEWEST).bit_length() - 1


@cache
def choose_method(batch: int, channels: int, out: int) -> Method:
    """The method with the least time a tet and shape.

    `columns` gathers five rows beside each other and multiplies once: only B = 1 leaves them in order.
    `accumulate` adds a product for each slot. `first` multiplies, then sums rows of results: for few of them.
    """
    times: dict[Method, float] = {
        "accumulate": SLOTS * _product(channels, out) + (SLOTS - 1) * _row(batch * channels) / batch,
        "first": _products_first(batch, channels, out) + SLOTS * 1.5 * _row(batch * out) / batch,
    }
    if batch == 1:
        times["columns"] = _product(SLOTS * channels, out) + SLOTS * _row(channels)
    return min(times, key=times.__getitem__)


def _product(inner: int, out: int) -> float:
    """A row of a matrix product; fewer than 16 columns leave most of a vector register empty."""
    if out == 1:
        return 1 + 0.08 * inner
    if out <= 8:
        return 2 + 1.08 * inner
    filled = -out % 16 + out
    return filled * (0.1 + 0.0205 * inner) * (1.6 if out < 16 else 1)


def _row(numbers: int) -> float:
    """A gathered row: an address to follow, then bytes from the second or third cache."""
    return 4 + _NUMBER * numbers / 32


def _products_first(batch: int, channels: int, out: int) -> float:
    if out == 1:
        return SLOTS * _product(channels, 1)
    permuted = 0.0 if batch == 1 else SLOTS * (4 + 0.4 * out)
    return _product(channels, SLOTS * out) + permuted
