"""Fixed sparse matrices over the rows of a tensor: neighbours, upsampling, Eq. 3."""

from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from scipy import sparse
from torch import Tensor, nn
from torch.nn import functional


class RowMap(nn.Module):
    """A constant sparse matrix A (M, N) applied along the first axis of a tensor (N, ...).

    Both the product and its adjoint are sums of gathered rows, one bag of rows an output row. Nothing is
    scattered, so no atomics are needed, results do not depend on thread timing, and a gathered row is
    contiguous: on a CPU the product costs little more than a copy.
    """

    def __init__(self, matrix: sparse.csr_array) -> None:
        super().__init__()
        matrix = sparse.csr_array(matrix)
        self.shape: tuple[int, int] = matrix.shape
        self.is_selection = bool((matrix.data == 1).all())
        self._keep("product", matrix)
        self._keep("adjoint", sparse.csr_array(matrix.T))

    def _keep(self, name: str, matrix: sparse.csr_array) -> None:
        matrix.sort_indices()  # one order of summation, so one result
        parts = {"rows": matrix.indices.astype(np.int32), "starts": matrix.indptr.astype(np.int32)}
        if not self.is_selection:
            parts["weights"] = matrix.data.astype(np.float32)
        for part, values in parts.items():
            # The grid determines these; they are not weights to be saved.
            self.register_buffer(f"{name}_{part}", torch.from_numpy(values), persistent=False)

    def forward(self, x: Tensor) -> Tensor:
        """(N, ...) to (M, ...), differentiable any number of times."""
        return _Product.apply(x, self, "product")

    def sum_rows(self, x: Tensor, side: str) -> Tensor:
        """A x (`side` "product") or Aᵀ x ("adjoint") without recording gradients."""
        weights = None
        if not self.is_selection:
            weights = getattr(self, f"{side}_weights").to(x.dtype)
        summed = functional.embedding_bag(
            getattr(self, f"{side}_rows"),
            x.reshape(x.shape[0], -1),
            getattr(self, f"{side}_starts"),
            mode="sum",
            per_sample_weights=weights,
            include_last_offset=True,
        )
        return summed.view(-1, *x.shape[1:])


class _Product(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, x: Tensor, rows: RowMap, side: str) -> Tensor:
        ctx.rows, ctx.side = rows, side
        return rows.sum_rows(x, side)

    @staticmethod
    def backward(ctx: Any, grad: Tensor) -> tuple[Tensor, None, None]:  # type: ignore[override]
        other = "adjoint" if ctx.side == "product" else "product"
        return _Product.apply(grad, ctx.rows, other), None, None


def dense(rows: RowMap) -> Float[Tensor, "M N"]:
    """The matrix written out, for small examples."""
    return rows.sum_rows(torch.eye(rows.shape[1]), "product")
