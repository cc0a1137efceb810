"""The convolution as one Triton kernel: rows are gathered straight into the tiles of a matrix product.

No gathered row goes back to memory, and nothing is scattered: the adjoint gathers the rows that point
at a tet, and the gradient of the weights adds up the products of fixed ranges of rows in a fixed order.
So results are the same every time.
"""

from typing import Any

import numpy as np
import torch
import triton
import triton.language as tl
from jaxtyping import Float
from torch import Tensor
from triton import knobs

from tetgan.nn.neighbors import SLOTS, Side, TetNeighbors

_SPLITS = 128  # ranges of rows that the gradient of the weights sums side by side

_ROWS = 64  # of a tile in it

_INTERPRETED = knobs.runtime.interpret


# Tiles differ in rows only: the order of summation, so the result, does not depend on which one wins.
_TILES = [
    triton.Config({"ROWS": rows}, num_warps=warps, num_stages=stages)
    for rows, warps, stages in ((128, 4, 3), (128, 8, 3), (64, 4, 4))
]


@triton.autotune(_TILES[:1] if _INTERPRETED else _TILES, key=["CHANNELS", "OUT", "DEPTH", "PRECISION"])
@triton.jit
def _conv_kernel(  # type: ignore[no-untyped-def]  # noqa: PLR0917
    x,
    weight,
    bias,
    y,
    table,
    tets,
    batch,
    slot_stride,
    channel_stride,
    out_stride,
    CHANNELS: tl.constexpr,
    OUT: tl.constexpr,
    DEPTH: tl.constexpr,
    HAS_BIAS: tl.constexpr,
    PRECISION: tl.constexpr,
    FACTOR: tl.constexpr,
    SUM: tl.constexpr,
    INNER: tl.constexpr,
    COLUMNS: tl.constexpr,
    ROWS: tl.constexpr,
):
    """y[t, b] = Σ_s Σ_d x[table[t, s, d], b] W_s + bias; a tile is ROWS pairs (t, b) by COLUMNS outputs."""
    row = tl.program_id(0) * ROWS + tl.arange(0, ROWS)
    column = tl.program_id(1) * COLUMNS + tl.arange(0, COLUMNS)
    tet = row // batch
    shape = row - tet * batch
    inside = tet < tets
    blocks: tl.constexpr = (CHANNELS + INNER - 1) // INNER
    total = tl.full((ROWS, COLUMNS), 0, SUM)
    for step in range(5 * blocks):
        slot = step // blocks
        channel = (step - slot * blocks) * INNER + tl.arange(0, INNER)
        entry = table + (tet.to(tl.int64) * 5 + slot) * DEPTH
        source = tl.load(entry, mask=inside, other=-1)
        place = (source.to(tl.int64) * batch + shape)[:, None] * CHANNELS + channel[None, :]
        rows = tl.load(x + place, mask=(source >= 0)[:, None] & (channel < CHANNELS)[None, :], other=0.0)
        if DEPTH > 1:
            gathered = rows.to(SUM)
            for deep in tl.static_range(1, DEPTH):
                source = tl.load(entry + deep, mask=inside, other=-1)
                place = (source.to(tl.int64) * batch + shape)[:, None] * CHANNELS + channel[None, :]
                more = (source >= 0)[:, None] & (channel < CHANNELS)[None, :]
                gathered += tl.load(x + place, mask=more, other=0.0).to(SUM)
            rows = gathered.to(x.dtype.element_ty)
        matrix = tl.load(
            weight + slot * slot_stride + channel[:, None] * channel_stride + column[None, :] * out_stride,
            mask=(channel < CHANNELS)[:, None] & (column < OUT)[None, :],
            other=0.0,
        )
        total = tl.dot(rows.to(FACTOR), matrix.to(FACTOR), total, input_precision=PRECISION, out_dtype=SUM)
    if HAS_BIAS:
        total += tl.load(bias + column, mask=column < OUT, other=0.0).to(SUM)[None, :]
    place = row.to(tl.int64)[:, None] * OUT + column[None, :]
    tl.store(y + place, total.to(y.dtype.element_ty), mask=inside[:, None] & (column < OUT)[None, :])


@triton.jit
def _weight_kernel(  # type: ignore[no-untyped-def]  # noqa: PLR0917
    x,
    grad,
    partial,
    table,
    tets,
    batch,
    rows_each,
    CHANNELS: tl.constexpr,
    OUT: tl.constexpr,
    PRECISION: tl.constexpr,
    FACTOR: tl.constexpr,
    SUM: tl.constexpr,
    INNER: tl.constexpr,
    COLUMNS: tl.constexpr,
    ROWS: tl.constexpr,
):
    """partial[split, s] = x[table[t, s], b]ᵀ grad[t, b] over the split's rows (t, b); one tile of it."""
    tiles: tl.constexpr = (OUT + COLUMNS - 1) // COLUMNS
    slot = tl.program_id(0) % 5  # neighbors in time share the rows of `grad`
    tile = tl.program_id(0) // 5
    split = tl.program_id(1)
    channel = (tile // tiles) * INNER + tl.arange(0, INNER)
    column = (tile % tiles) * COLUMNS + tl.arange(0, COLUMNS)
    total = tl.full((INNER, COLUMNS), 0, SUM)
    for first in range(0, rows_each, ROWS):
        row = split * rows_each + first + tl.arange(0, ROWS)
        tet = row // batch
        shape = row - tet * batch
        inside = tet < tets
        source = tl.load(table + tet.to(tl.int64) * 5 + slot, mask=inside, other=-1)
        place = (source.to(tl.int64) * batch + shape)[:, None] * CHANNELS + channel[None, :]
        rows = tl.load(x + place, mask=(source >= 0)[:, None] & (channel < CHANNELS)[None, :], other=0.0)
        place = row.to(tl.int64)[:, None] * OUT + column[None, :]
        grads = tl.load(grad + place, mask=inside[:, None] & (column < OUT)[None, :], other=0.0)
        total = tl.dot(
            tl.trans(rows.to(FACTOR)), grads.to(FACTOR), total, input_precision=PRECISION, out_dtype=SUM
        )
    place = (split * 5 + slot) * CHANNELS * OUT + channel[:, None] * OUT + column[None, :]
    tl.store(partial + place, total, mask=(channel < CHANNELS)[:, None] & (column < OUT)[None, :])


def conv(
    x: Float[Tensor, "T B C"],
    weight: Float[Tensor, "5 C D"],
    bias: Float[Tensor, "D"] | None,
    neighbors: TetNeighbors,
    side: Side,
) -> Float[Tensor, "T B D"]:
    """Σ_s shift_s(x) W_s + bias; products in the dtype of x, sums in float32."""
    x, table = x.contiguous(), neighbors.padded(side)
    (tets, batch, channels), out = x.shape, weight.shape[2]
    y = x.new_empty(tets, batch, out)
    block = _block(out, 128 if x.element_size() < 4 else 64)

    def grid(chosen: dict[str, Any]) -> tuple[int, int]:
        return triton.cdiv(tets * batch, chosen["ROWS"]), triton.cdiv(out, block)

    with torch.cuda.device_of(x):
        _conv_kernel[grid](
            x,
            weight,
            y if bias is None else bias,
            y,
            table,
            tets,
            batch,
            *weight.stride(),
            CHANNELS=channels,
            OUT=out,
            DEPTH=table.shape[2],
            HAS_BIAS=bias is not None,
            INNER=_block(channels, 64 if x.element_size() < 4 else 32),
            COLUMNS=block,
            **_arithmetic(x),
        )
    return y


def weight_gradient(
    x: Float[Tensor, "T B C"], grad: Float[Tensor, "T B D"], neighbors: TetNeighbors, side: Side
) -> Float[Tensor, "5 C D"]:
    """shift_s(x)ᵀ g of every slot; an adjoint shift of x is a shift of g, which gathers one row a slot."""
    if side == "adjoint":
        return weight_gradient(grad, x, neighbors, "product").mT
    x, grad, table = x.contiguous(), grad.contiguous(), neighbors.padded(side)
    (tets, batch, channels), out = x.shape, grad.shape[2]
    splits = int(np.clip(tets * batch // (16 * _ROWS), 1, _SPLITS))
    partial = x.new_empty(splits, SLOTS, channels, out, dtype=torch.promote_types(x.dtype, torch.float32))
    inner, block = _block(channels, 64), _block(out, 64)
    tiles = triton.cdiv(channels, inner) * triton.cdiv(out, block)
    with torch.cuda.device_of(x):
        _weight_kernel[(SLOTS * tiles, splits)](
            x,
            grad,
            partial,
            table,
            tets,
            batch,
            triton.cdiv(triton.cdiv(tets * batch, splits), _ROWS) * _ROWS,
            CHANNELS=channels,
            OUT=out,
            INNER=inner,
            COLUMNS=block,
            ROWS=_ROWS,
            num_warps=4,
            num_stages=3,
            **_arithmetic(x),
        )
    return partial.sum(dim=0).to(x.dtype)


def conv_and_weight_gradient(
    x: Float[Tensor, "T B C"],
    weight: Float[Tensor, "5 C D"],
    other: Float[Tensor, "T B E"],
    neighbors: TetNeighbors,
    side: Side,
) -> tuple[Float[Tensor, "T B D"], Float[Tensor, "5 C E"]]:
    """Σ_s shift_s(x) W_s, and shift_s(x)ᵀ `other` of every slot; one kernel each."""
    return conv(x, weight, None, neighbors, side), weight_gradient(x, other, neighbors, side)


def try_out() -> None:
    """Run both kernels on two tets; raises whatever keeps them from running."""
    neighbors = TetNeighbors(np.array([[1, -1, -1, -1], [0, -1, -1, -1]])).to("cuda")
    x = torch.ones(2, 1, 1, device="cuda")
    y = conv(x, torch.ones(SLOTS, 1, 1, device="cuda"), None, neighbors, "product")
    total = weight_gradient(x, y, neighbors, "product").sum().item()
    if total != 8:
        raise ArithmeticError(f"a kernel returned {total} for 8")


def _block(numbers: int, most: int) -> int:
    """Side of a tile: the tensor cores' least, 16, or more."""
    return min(max(triton.next_power_of_2(numbers), 16), most)


def _arithmetic(x: Tensor) -> dict[str, Any]:
    """Factors as they come, sums in float32; TF32 where PyTorch's own products may use it."""
    kind = {torch.float64: tl.float64, torch.float16: tl.float16, torch.bfloat16: tl.bfloat16}
    factor = kind.get(x.dtype, tl.float32)
    if _INTERPRETED and x.element_size() < 4:
        factor = tl.float32  # the interpreter would multiply the bits of a bfloat16 as an integer
    fast = factor is tl.float32 and torch.get_float32_matmul_precision() != "highest" and not _INTERPRETED
    return {
        "FACTOR": factor,
        "SUM": tl.float64 if factor is tl.float64 else tl.float32,
        "PRECISION": "tf32" if fast else "ieee",
    }
