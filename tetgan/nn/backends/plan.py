"""Cost model that chooses the order of gathering and multiplying on a CPU.

A model rather than a measurement: the methods round differently, and the same machine must give the same
bytes every time. The constants are nanoseconds of one AVX-512 core (docs/kernels.md).
"""

from functools import cache
from typing import Literal

import torch
from jaxtyping import Float
from torch import Tensor

from tetgan.nn.neighbors import SLOTS

Method = Literal["columns", "first"]

CHUNK_BYTES = 1 << 20  # of a chunk, a thread: gathered rows and what they meet, in a core's own cache

TABLE_BYTES = 96 << 20  # of products, kept from one convolution to the next

_FEWEST = 64  # tets in a chunk; fewer would be all overhead

_NUMBER = 4  # bytes

_LANES = 16  # numbers of a vector register


def chunk_size(x: Float[Tensor, "T B C"], *along: Float[Tensor, "T B _"]) -> int:
    """Tets to take at a time when five rows of `x` meet one of each of the others; all of them off the CPU.

    A power of two.
    """
    if x.device.type != "cpu":
        return max(len(x), 1)
    a_tet = SLOTS * x[0].nbytes + sum(each[0].nbytes for each in along)
    fit = CHUNK_BYTES * torch.get_num_threads() // a_tet
    return 1 << max(fit, _FEWEST).bit_length() - 1


def rows_in_table(out: int) -> int:
    """Of results a tet and shape, where products come first: the five slots, or what fills a register."""
    return max(SLOTS, _LANES // out) if _LANES % out == 0 else SLOTS


@cache
def choose_method(rows: int, channels: int, out: int, gathered_again: int = 0) -> Method:
    """The method with the least time for `rows` rows of tets and shapes.

    `columns` gathers five rows beside each other and multiplies once. `first` multiplies, then sums rows of
    results, from a table that is large unless they are few. Who has another use for the columns says how
    many channels it would gather without them.
    """
    table = rows_in_table(out) * out
    columns = _product(SLOTS * channels, out) + SLOTS * _gathered(channels)
    first = _product(channels, table) + table * _through_memory(rows * table) + SLOTS * _summed(out)
    again = SLOTS * _gathered(gathered_again) if gathered_again else 0.0
    return "columns" if columns <= first + again else "first"


def _product(inner: int, out: int) -> float:
    """A row of a matrix product, in whole vector registers."""
    return (-out % _LANES + out) * (0.05 + 0.0135 * inner)


def _gathered(numbers: int) -> float:
    """A row copied: an address to follow, then bytes from the second or third cache."""
    return 2.8 + 0.26 * numbers


def _summed(numbers: int) -> float:
    """A row added to a sum."""
    return 1.6 + 0.05 * numbers


def _through_memory(numbers: int) -> float:
    """A number of a table that is written and read again; a large one is made of new pages each time."""
    return 0.15 if _NUMBER * numbers <= TABLE_BYTES else 2.2
