"""Choice of the backend that computes a convolution."""

import importlib
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from typing import Literal, Protocol, cast, get_args, runtime_checkable

import torch
from torch import Tensor

from tetgan.errors import UserError
from tetgan.nn.neighbors import Side, TetNeighbors

_log = logging.getLogger(__name__)

Backend = Literal["reference", "cpu", "triton"]

_forced: Backend | None = None


@runtime_checkable
class Kernels(Protocol):
    """Functions that a backend offers to the differentiable operator; none records gradients."""

    def conv(
        self, x: Tensor, weight: Tensor, bias: Tensor | None, neighbors: TetNeighbors, side: Side
    ) -> Tensor:
        """Σ_s shift_s(x) W_s + bias, (T, B, D)."""
        ...

    def weight_gradient(self, x: Tensor, grad: Tensor, neighbors: TetNeighbors, side: Side) -> Tensor:
        """shift_s(x)ᵀ g of every slot, (5, C, D)."""
        ...

    def conv_and_weight_gradient(
        self, x: Tensor, weight: Tensor, other: Tensor, neighbors: TetNeighbors, side: Side
    ) -> tuple[Tensor, Tensor]:
        """Both of x at once, the second with `other` (T, B, E): what a backward pass needs."""
        ...


@contextmanager
def conv_backend(name: str) -> Iterator[None]:
    """Convolutions called inside use this backend on any device.

    Raises:
        UserError: there is no such backend, or it is `triton` and Triton is not installed.
    """
    global _forced  # noqa: PLW0603 - the backward pass of a GPU runs in another thread
    if name not in get_args(Backend):
        raise UserError(f"convolution backend '{name}': choose one of {', '.join(get_args(Backend))}")
    if name == "triton" and find_spec("triton") is None:
        raise UserError("convolution backend 'triton': Triton is not installed; use 'cpu' or install triton")
    before, _forced = _forced, cast("Backend", name)
    try:
        yield
    finally:
        _forced = before


def backend_for(device: torch.device, dtype: torch.dtype) -> Backend:
    """The forced backend; else Triton on a GPU where it works, and PyTorch's operations elsewhere."""
    if _forced is not None:
        return _forced
    if device.type != "cuda" or dtype == torch.float64:
        return "cpu"
    return "triton" if triton_works() else "cpu"


def kernels(backend: Backend) -> Kernels:
    """The module of a backend, imported when first asked for."""
    return importlib.import_module(f"tetgan.nn.backends.{backend}")  # type: ignore[return-value]


@cache
def triton_works() -> bool:
    """Whether Triton can build and run a kernel here; says once, in the log, why it cannot."""
    try:
        kernels("triton").try_out()  # type: ignore[attr-defined]
    except Exception as error:  # an import, a driver, a compiler: whatever it is, there is another way
        reason = str(error).strip().partition("\n")[0] or type(error).__name__
        _log.warning(
            "Triton does not work here (%s): convolutions on the GPU use PyTorch's own operations, which"
            " are slower and need more memory",
            reason,
        )
        return False
    return True
