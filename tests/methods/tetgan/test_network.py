"""Sizes and symmetries of the networks."""

from collections.abc import Iterable

import pytest
import torch
from torch import nn

from tetgan.grids.grid import TetGrid
from tetgan.grids.hierarchy import GridHierarchy, build_hierarchy, subdivide_hierarchy
from tetgan.methods.tetgan.critics import GlobalCritic, LocalCritic
from tetgan.methods.tetgan.network import TetganGenerator, TetHierarchy
from tetgan.methods.tetgan.options import TetganOptions
from tetgan.nn.conv import TetConv

SMALL = {"grid": "smoke", "width": 8, "code": 12}


def million_parameters(modules: Iterable[nn.Module]) -> float:
    return sum(p.numel() for module in modules for p in module.parameters()) / 1e6


def hierarchy_of_base(base_tets: int) -> GridHierarchy:
    """Depth 3, but only the coarsest level is whole: no weight depends on the size of the others."""
    lattice = build_hierarchy(2 if base_tets <= 144 else 3, 0).finest
    base = TetGrid(lattice.vertices, lattice.tets[:base_tets])
    speck = TetGrid(lattice.vertices, lattice.tets[:1])
    return GridHierarchy((base, *subdivide_hierarchy(speck, 3).levels[1:]))


@pytest.mark.parametrize(
    ("base_tets", "latent", "expected"),
    [
        (134, "global", 83.0),
        (402, "global", 223.7),
        (144, "global", 88.3),
        (432, "global", 239.4),
        (134, "tet", 13.2),
    ],
)
def test_parameter_counts_at_paper_width(base_tets, latent, expected):
    options = TetganOptions(grid="LR", latent=latent, upsample="copy")
    with torch.device("meta"):
        model = TetganGenerator(options, hierarchy_of_base(base_tets))
    assert round(million_parameters([model]), 1) == expected


@pytest.mark.parametrize(("base_tets", "expected"), [(134, 4.41), (402, 4.55)])
def test_critics_at_paper_width(base_tets, expected):
    hierarchy = TetHierarchy(hierarchy_of_base(base_tets), "copy")
    with torch.device("meta"):
        critics = LocalCritic(hierarchy, 16), GlobalCritic(hierarchy, 64)
    assert round(million_parameters(critics[:1]), 2) == 0.22
    assert round(million_parameters(critics[1:]), 2) == expected


@pytest.mark.parametrize("latent", ["global", "tet", "conv"])
def test_shapes_and_ranges(latent):
    hierarchy = build_hierarchy(1, 1)
    model = TetganGenerator(TetganOptions(latent=latent, **SMALL), hierarchy)
    field = torch.rand(3, len(hierarchy.finest.tets), 4)
    code = model.encode(field)
    assert code.shape == (3, 12) if latent == "global" else (3, 24, 12)
    assert code.shape == model.sample_latent(3, torch.Generator()).shape
    decoded = model.decode(code)
    assert decoded.shape == field.shape
    assert decoded[..., 1:].abs().max() <= 1


def test_base_width_is_independent_of_the_code():
    model = TetganGenerator(TetganOptions(latent="tet", base_width=20, **SMALL), build_hierarchy(1, 1))
    assert model.head.hidden.in_features == 20
    assert model.latent_shape == (24, 12)


def test_shapes_of_a_batch_are_independent():
    hierarchy = build_hierarchy(1, 1)
    model = TetganGenerator(TetganOptions(**SMALL), hierarchy)
    critic = GlobalCritic(model.hierarchy, 4)
    field = torch.rand(3, len(hierarchy.finest.tets), 4, generator=torch.Generator().manual_seed(0))
    together, alone = model.decode(model.encode(field))[1:2], model.decode(model.encode(field[1:2]))
    # Single precision, a dozen layers.
    torch.testing.assert_close(together, alone, rtol=1e-4, atol=1e-4)
    torch.testing.assert_close(critic(field)[1:2], critic(field[1:2]), rtol=1e-4, atol=1e-4)


def test_critics_have_gradients_of_their_gradients():
    hierarchy = TetHierarchy(build_hierarchy(1, 1))
    field = torch.rand(2, hierarchy.tets[-1], 4, requires_grad=True)
    for critic in LocalCritic(hierarchy, 4), GlobalCritic(hierarchy, 4):
        (gradient,) = torch.autograd.grad(critic(field).sum(), field, create_graph=True)
        gradient.square().sum().backward()
        assert all(p.grad is not None for name, p in critic.named_parameters() if "bias" not in name)


@pytest.mark.parametrize("latent", ["global", "tet", "conv"])
def test_a_head_started_from_features_gives_them_back(latent):
    # Six shapes span five directions, 24 tets of channels eight: a code of 12 holds either.
    options = TetganOptions.parse({**SMALL, "latent": latent, "base_width": 8})
    model = TetganGenerator(options, build_hierarchy(1, 1))
    features = torch.rand(24, 6, 8, generator=torch.Generator().manual_seed(0))
    model.head.start_from(features)
    codes, log_variance = model.head.encode(features)
    torch.testing.assert_close(model.head.decode(codes), features, rtol=0, atol=1e-4)
    kept = codes.flatten(0, -2)[:, :5]
    torch.testing.assert_close(kept.var(dim=0, correction=0), torch.ones(5), rtol=1e-3, atol=0)
    assert (log_variance < -2).all()


def shapes_of(**changes) -> dict[str, torch.Size]:
    """Sizes of all weights of a small model."""
    model = TetganGenerator(TetganOptions.parse({**SMALL, **changes}), build_hierarchy(1, 1))
    return {name: value.shape for name, value in model.state_dict().items()}


@pytest.mark.parametrize("latent", ["global", "conv"])
def test_shared_convolutions_change_the_number_of_matrices_alone(latent):
    full, shared = shapes_of(latent=latent), shapes_of(latent=latent, convolution="shared")
    assert full.keys() == shared.keys()
    convolutions = {name for name, shape in full.items() if len(shape) == 3 and shape[0] == 5}
    for name, shape in shared.items():
        assert shape == (torch.Size([2, *full[name][1:]]) if name in convolutions else full[name])


def test_critics_share_too_where_the_model_does():
    model = TetganGenerator(TetganOptions.parse({**SMALL, "convolution": "shared"}), build_hierarchy(1, 1))
    for critic in LocalCritic(model.hierarchy, 2), GlobalCritic(model.hierarchy, 2):
        convolutions = [module for module in critic.modules() if isinstance(module, TetConv)]
        assert convolutions and all(len(module.weight) == 2 for module in convolutions)


def test_without_displacement_only_the_ends_are_thinner():
    full, bare = shapes_of(), shapes_of(displacement=False)
    assert full.keys() == bare.keys()
    first, *_ = (name for name in full if name.startswith("encoder"))
    last = [name for name in full if name.startswith("decoder")][-2:]  # weight and bias
    thinner = {name: (full[name], bare[name]) for name in full if full[name] != bare[name]}
    assert thinner == {
        first: (torch.Size([5, 4, 8]), torch.Size([5, 1, 8])),
        last[0]: (torch.Size([5, 8, 4]), torch.Size([5, 8, 1])),
        last[1]: (torch.Size([4]), torch.Size([1])),
    }


def test_without_displacement_none_is_read_or_written():
    model = TetganGenerator(TetganOptions.parse({**SMALL, "displacement": False}), build_hierarchy(1, 1))
    field = torch.rand(2, 192, 4, generator=torch.Generator().manual_seed(0))
    other = torch.cat([field[..., :1], -field[..., 1:]], dim=-1)
    code = model.encode(field)
    assert torch.equal(code, model.encode(other))
    for seen in model.decode(code), model.in_range(field):
        assert seen.shape == field.shape
        assert not seen[..., 1:].any()
    assert torch.equal(model.in_range(field)[..., 0], field[..., 0])
