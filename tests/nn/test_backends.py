"""Backends of the convolution against the reference, and how one is chosen."""

import logging
import sys
from importlib.util import find_spec

import numpy as np
import pytest
import torch

from tetgan.errors import UserError
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.nn import neighbors as neighbors_module
from tetgan.nn.backends import choice, cpu, plan, reference
from tetgan.nn.backends.choice import backend_for, triton_works
from tetgan.nn.conv import SLOTS, TetNeighbors, conv_backend, tet_conv

needs_triton = pytest.mark.skipif(find_spec("triton") is None, reason="Triton is not installed")
BACKENDS = ["cpu", pytest.param("triton", marks=needs_triton)]


@pytest.fixture(scope="module")
def neighbors() -> np.ndarray:
    return build_hierarchy(1, 1).finest.neighbors


@pytest.fixture(scope="module")
def few() -> np.ndarray:
    return build_hierarchy(1, 0).finest.neighbors


@pytest.fixture(params=BACKENDS)
def backend(request) -> str:
    if request.param == "triton" and not torch.cuda.is_available():
        from tetgan.nn.backends import triton

        if not triton._INTERPRETED:
            pytest.skip("Triton was imported before its interpreter was asked for")
    return request.param


def draw(seed, *shape, dtype=torch.float32):
    generator = torch.Generator().manual_seed(seed)
    return torch.randn(*shape, generator=generator, dtype=torch.float64).to(dtype).requires_grad_()


def on_device(backend):
    return "cuda" if backend == "triton" and torch.cuda.is_available() else "cpu"


def derivatives(backend, table, x, weight, bias):
    """y, its gradients for a cotangent that depends on it, and the gradients of their squares."""
    device = on_device(backend)
    maps, inputs = TetNeighbors(table).to(device), [v.detach().to(device) for v in (x, weight, bias)]
    inputs = [v.requires_grad_() for v in inputs]
    with conv_backend(backend):
        y = tet_conv(*inputs, maps)
        first = torch.autograd.grad(y.square().sum(), inputs, create_graph=True)
        second = torch.autograd.grad(sum(g.square().sum() for g in first), inputs)
    return [v.detach().cpu() for v in (y, *first, *second)]


@pytest.mark.parametrize(("channels", "out", "batch"), [(1, 3, 3), (17, 5, 1), (3, 1, 2), (5, 17, 2)])
def test_agrees_with_the_reference_twice_differentiated(neighbors, backend, channels, out, batch):
    inputs = (
        draw(0, len(neighbors), batch, channels),
        draw(1, SLOTS, channels, out),
        draw(2, out),
    )
    got = derivatives(backend, neighbors, *inputs)
    wanted = derivatives("reference", neighbors, *(v.double() for v in inputs))
    for ours, exact in zip(got, wanted, strict=True):
        # float32 has 24 bits; sums of up to 576 products, three times over
        torch.testing.assert_close(ours.double(), exact, rtol=0, atol=2e-6 * float(exact.abs().max()))


@needs_triton
def test_a_tile_is_smaller_than_the_channels(few):
    inputs = draw(0, len(few), 2, 70), draw(1, SLOTS, 70, 66), draw(2, 66)
    maps = TetNeighbors(few).to(on_device("triton"))
    with conv_backend("triton"):
        got = tet_conv(*(v.to(on_device("triton")) for v in inputs), maps)
    wanted = reference.tet_conv(*inputs, TetNeighbors(few))
    torch.testing.assert_close(got.cpu(), wanted, rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("backend", BACKENDS[1:], indirect=True)
def test_gradient_of_the_weights_from_several_ranges_of_rows(neighbors, backend):
    device, maps = on_device(backend), TetNeighbors(neighbors)
    x, grad = draw(0, len(neighbors), 11, 2).detach(), draw(1, len(neighbors), 11, 3).detach()
    kernels = choice.kernels(backend)
    assert x.shape[0] * x.shape[1] >= 2 * 16 * kernels._ROWS  # two ranges, of which the second is not full
    wanted = cpu.weight_gradient(x.double(), grad.double(), maps, "product")
    once, again = (
        kernels.weight_gradient(x.to(device), grad.to(device), maps.to(device), "product") for _ in range(2)
    )
    assert torch.equal(once, again)
    torch.testing.assert_close(once.cpu().double(), wanted, rtol=0, atol=2e-6 * float(wanted.abs().max()))


@pytest.mark.parametrize("backend", [*BACKENDS, "reference"], indirect=True)
def test_derivatives_of_every_backend_in_float64(few, backend):
    if on_device(backend) == "cuda":
        pytest.skip("Triton's kernels take float64 in the interpreter only")
    maps, shapes = TetNeighbors(few), [(len(few), 1, 3), (SLOTS, 3, 2), (2,)]
    inputs = tuple(draw(seed, *shape, dtype=torch.float64) for seed, shape in enumerate(shapes))
    with conv_backend(backend):
        assert torch.autograd.gradcheck(lambda *a: tet_conv(*a, maps), inputs, fast_mode=True)
        assert torch.autograd.gradgradcheck(lambda *a: tet_conv(*a, maps), inputs, fast_mode=True)


@pytest.mark.parametrize("backend", [*BACKENDS, "reference"], indirect=True)
def test_the_same_bytes_twice(few, backend):
    inputs = draw(0, len(few), 3, 9), draw(1, SLOTS, 9, 11), draw(2, 11)
    once, again = (derivatives(backend, few, *inputs) for _ in range(2))
    assert all(torch.equal(one, other) for one, other in zip(once, again, strict=True))


def test_half_precision_of_every_backend(few, backend):
    device = on_device(backend)
    drawn = draw(0, len(few), 2, 12), draw(1, SLOTS, 12, 16), draw(2, 16)
    x, weight, bias = (v.detach().to(device) for v in drawn)
    maps, weight = TetNeighbors(few).to(device), weight / 60**0.5
    with conv_backend(backend), torch.autocast(device, torch.bfloat16):
        half = tet_conv(x, weight, bias, maps)
    assert half.dtype == torch.bfloat16
    # bfloat16 has 8 bits; sums of 60 products of size about 0.1
    torch.testing.assert_close(half.float(), reference.tet_conv(x, weight, bias, maps), rtol=0.05, atol=0.05)


@pytest.mark.parametrize("side", ["product", "adjoint"])
@pytest.mark.parametrize("method", ["columns", "first"])
@pytest.mark.parametrize("widths", [(1, 4), (3, 4), (1, 1), (3, 1), (3, 2), (2, 17)])
def test_every_order_of_gathering_and_multiplying(neighbors, monkeypatch, method, widths, side):
    batch, out = widths
    monkeypatch.setattr(cpu, "choose_method", lambda *_: method)
    monkeypatch.setattr(cpu, "chunk_size", lambda *_: 80)  # 192 tets: the last chunk is not full
    shapes = (len(neighbors), batch, 6), (SLOTS, 6, out), (out,)
    x, weight, bias = (draw(s, *shape, dtype=torch.float64).detach() for s, shape in enumerate(shapes))
    wanted = sum(shift(neighbors, slot, side) @ (x @ weight[slot]).flatten(1) for slot in range(SLOTS))
    for offset in (bias, None):
        got = cpu.conv(x, weight, offset, TetNeighbors(neighbors), side)
        right = wanted.view(got.shape) + (0 if offset is None else offset)
        torch.testing.assert_close(got, right, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("method", ["columns", "first"])
@pytest.mark.parametrize("other", [3, 9, 40])
def test_both_products_of_the_same_rows(neighbors, monkeypatch, method, other):
    monkeypatch.setattr(cpu, "choose_method", lambda *_: method)
    monkeypatch.setattr(cpu, "chunk_size", lambda *_: 80)
    shapes = (len(neighbors), 2, 6), (SLOTS, 6, 4), (len(neighbors), 2, other)
    x, weight, z = (draw(s, *shape, dtype=torch.float64).detach() for s, shape in enumerate(shapes))
    maps = TetNeighbors(neighbors)
    got = cpu.conv_and_weight_gradient(x, weight, z, maps, "adjoint")
    wanted = cpu.conv(x, weight, None, maps, "adjoint"), cpu.weight_gradient(x, z, maps, "adjoint")
    torch.testing.assert_close(got, wanted, rtol=1e-12, atol=1e-12)


def test_memory_for_products_is_used_again_and_never_handed_out(neighbors, monkeypatch):
    monkeypatch.setattr(cpu, "choose_method", lambda *_: "first")
    maps, results = TetNeighbors(neighbors), []
    for batch in (2, 1, 3):
        x, weight = draw(batch, len(neighbors), batch, 6).detach(), draw(9, SLOTS, 6, 4).detach()
        results.append((cpu.conv(x, weight, None, maps, "product"), x, weight))
    for got, x, weight in results:
        torch.testing.assert_close(got, reference.tet_conv(x, weight, None, maps), rtol=1e-4, atol=1e-4)
    block = cpu._kept.block.data_ptr()
    assert all(got.untyped_storage().data_ptr() != block for got, _, _ in results)
    monkeypatch.setattr(cpu, "TABLE_BYTES", 0)
    got, x, weight = results[0]
    assert torch.equal(cpu.conv(x, weight, None, maps, "product"), got)


@pytest.mark.parametrize("rows", [1, 7, 64, 96])
def test_bias_of_any_number_of_rows(rows):
    y, bias = draw(0, rows, 3).detach(), draw(1, 3).detach()
    wanted = y + bias
    cpu._add_to_rows(y, bias)
    assert torch.equal(y, wanted)


@pytest.mark.parametrize("method", cpu._METHODS)
@pytest.mark.parametrize("side", ["product", "adjoint"])
def test_every_method_adds_the_bias_once(neighbors, method, side):
    maps, x, weight, bias = (
        TetNeighbors(neighbors),
        draw(0, len(neighbors), 2, 3),
        draw(1, SLOTS, 3, 4),
        draw(2, 4),
    )
    inputs = [v.detach() for v in (x, weight, bias)]
    plain = cpu._METHODS[method](inputs[0], inputs[1], None, maps, side)
    biased = cpu._METHODS[method](*inputs, maps, side)
    torch.testing.assert_close(biased, plain + inputs[2], rtol=0, atol=1e-6 * float(plain.abs().max()))


@pytest.mark.parametrize("few", [0, 1 << 19])
def test_chunks_share_the_rows_of_all_bags(neighbors, monkeypatch, few):
    monkeypatch.setattr(neighbors_module, "FEW", few)
    gathers = TetNeighbors(neighbors).gathers("adjoint", 3)
    for size in (80, 192, 1024):
        chunks = gathers.chunks(size)
        assert torch.equal(torch.cat([chunk.rows for chunk in chunks]), gathers.bags.rows)
        lengths = torch.cat([chunk.bags().starts.diff() for chunk in chunks])
        assert torch.equal(lengths, gathers.bags.starts.diff())
        assert all(chunk.bags().starts[0] == 0 for chunk in chunks)
        assert chunks[-1].rows.untyped_storage().data_ptr() == gathers.bags.rows.untyped_storage().data_ptr()


def test_tables_of_few_batches_are_kept(few, monkeypatch):
    monkeypatch.setattr(neighbors_module, "KEPT", 2)
    maps = TetNeighbors(few)
    first = maps.gathers("product", 1)
    assert maps.gathers("product", 1) is first
    for batch in (2, 3):
        maps.gathers("product", batch)
    assert maps.gathers("product", 1) is not first


@pytest.mark.parametrize("side", ["product", "adjoint"])
@pytest.mark.parametrize("shape", [(1, 3, 4), (1, 4, 3), (3, 3, 4), (3, 4, 3)])
def test_gradient_of_the_weights_by_chunks(neighbors, monkeypatch, shape, side):
    batch, channels, out = shape
    monkeypatch.setattr(cpu, "chunk_size", lambda *_: 80)
    x = draw(0, len(neighbors), batch, channels, dtype=torch.float64).detach()
    grad = draw(1, len(neighbors), batch, out, dtype=torch.float64).detach()
    wanted = [
        (shift(neighbors, slot, side) @ x.flatten(1)).view(-1, channels).T @ grad.flatten(0, 1)
        for slot in range(SLOTS)
    ]
    got = cpu.weight_gradient(x, grad, TetNeighbors(neighbors), side)
    torch.testing.assert_close(got, torch.stack(wanted), rtol=1e-12, atol=1e-12)


def shift(neighbors, slot, side):
    """The matrix (T, T) that picks the rows of a slot, by a loop."""
    matrix = torch.zeros(len(neighbors), len(neighbors), dtype=torch.float64)
    for tet, row in enumerate(neighbors):
        other = [tet, *row][slot]
        if other >= 0:
            matrix[tet, other] = 1
    return matrix if side == "product" else matrix.T


def test_tables_pad_each_bag_with_the_outside(neighbors):
    for side in ("product", "adjoint"):
        padded = TetNeighbors(neighbors).padded(side).numpy()
        for slot in range(SLOTS):
            wanted = shift(neighbors, slot, side).numpy()
            assert [sorted(row[row >= 0]) for row in padded[:, slot]] == [
                list(np.flatnonzero(row)) for row in wanted
            ]


def test_thin_outputs_are_multiplied_first():
    rows = 8 * 9216
    for channels in (4, 16, 64):
        assert plan.choose_method(rows, channels, 1) == plan.choose_method(rows, channels, 4) == "first"
        assert plan.choose_method(rows, 4, channels) == ("first" if channels == 4 else "columns")


def test_a_table_of_products_that_does_not_stay_costs_more_than_columns():
    assert plan.choose_method(9216, 64, 64) == "first"
    assert plan.choose_method(2**20, 64, 64) == "columns"


def test_columns_with_two_uses_are_gathered():
    assert plan.choose_method(9216, 16, 16) == "first"
    assert plan.choose_method(9216, 16, 16, gathered_again=16) == "columns"


def test_thin_tables_fill_a_register():
    assert [plan.rows_in_table(out) for out in (1, 2, 3, 4, 16, 64)] == [16, 8, 5, 5, 5, 5]


def test_chunks_are_powers_of_two_and_not_too_small():
    sizes = [plan.chunk_size(torch.empty(1, *shape)) for shape in [(1, 1), (8, 16), (8, 33), (30, 4096)]]
    assert all(size & (size - 1) == 0 for size in sizes)
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] == 64


def test_what_a_chunk_meets_makes_it_smaller():
    thin, wide = torch.empty(1, 1, 4), torch.empty(1, 1, 64)
    assert plan.chunk_size(thin, thin) > plan.chunk_size(thin, wide) > plan.chunk_size(thin, wide, wide)
    assert plan.chunk_size(thin.to("meta"), wide.to("meta")) == 1  # off the CPU: all tets


def test_the_device_chooses_and_a_caller_can_force(monkeypatch):
    monkeypatch.setattr(choice, "triton_works", lambda: True)
    gpu, host = torch.device("cuda"), torch.device("cpu")
    assert backend_for(gpu, torch.bfloat16) == "triton"
    assert backend_for(gpu, torch.float64) == backend_for(host, torch.float32) == "cpu"
    with conv_backend("cpu"):
        assert backend_for(gpu, torch.bfloat16) == "cpu"
        with conv_backend("reference"):
            assert backend_for(host, torch.float32) == "reference"
        assert backend_for(host, torch.float32) == "cpu"
    assert backend_for(gpu, torch.bfloat16) == "triton"


def test_an_unknown_backend_is_named():
    with (
        pytest.raises(UserError, match=r"'cuda': choose one of reference, cpu"),
        conv_backend("cuda"),
    ):
        pass


def chosen_three_times(caplog) -> set[str]:
    """What a GPU gets, asked anew, with what is said in the log."""
    triton_works.cache_clear()
    try:
        with caplog.at_level(logging.WARNING):
            return {backend_for(torch.device("cuda"), torch.float32) for _ in range(3)}
    finally:
        triton_works.cache_clear()


class NoCompiler:
    """A backend whose kernels cannot be built."""

    @staticmethod
    def try_out() -> None:
        raise RuntimeError("gcc: not found\nand a long trace")


def test_kernels_that_cannot_be_built_are_told_in_a_line(monkeypatch, caplog):
    monkeypatch.setattr(choice, "kernels", lambda _: NoCompiler)
    assert chosen_three_times(caplog) == {"cpu"}
    (line,) = (record.getMessage() for record in caplog.records)
    assert "(gcc: not found)" in line and "trace" not in line


def test_without_triton_a_gpu_falls_back_and_says_so_once(monkeypatch, caplog):
    monkeypatch.setitem(sys.modules, "triton", None)
    monkeypatch.delitem(sys.modules, "tetgan.nn.backends.triton", raising=False)
    assert chosen_three_times(caplog) == {"cpu"}
    assert len(caplog.records) == 1
    assert "Triton does not work here" in caplog.text
