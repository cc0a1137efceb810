"""Plain form of the tetrahedral convolution, the baseline of the benchmarks."""

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor
from torch.nn import functional


def around(neighbors: Int[np.ndarray, "T 4"]) -> Int[Tensor, "T 5"]:
    """Each tet and its four neighbors; -1, the outside, is the last row once zeros are padded behind."""
    return torch.from_numpy(np.column_stack([np.arange(len(neighbors)), neighbors]))


def naive_tet_conv(
    x: Float[Tensor, "B T C"],
    weight: Float[Tensor, "D 5*C"],
    bias: Float[Tensor, "D"] | None,
    neighbors: Int[Tensor, "T 5"],
) -> Float[Tensor, "B T D"]:
    """Pad with a zero row, index, reshape, one linear layer on 5 C inputs; `neighbors` as in `around`."""
    padded = functional.pad(x, (0, 0, 0, 1))
    return functional.linear(padded[:, neighbors].flatten(2), weight, bias)


def linear_form(weight: Float[Tensor, "5 C D"]) -> Float[Tensor, "D 5*C"]:
    """Five matrices as the weight of one linear layer."""
    return weight.flatten(0, 1).T.contiguous()
