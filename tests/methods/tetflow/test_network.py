"""The model of fields: what a decoder's outputs become, and how batches, depths and files treat it."""

import numpy as np
import pytest
import torch
from torch import nn

from tetgan.fields.field import Field, vertex_operator
from tetgan.grids.hierarchy import build_hierarchy
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.methods.tetflow.autoencoder import Autoencoder
from tetgan.methods.tetflow.network import TetflowGenerator
from tetgan.methods.tetflow.options import TetflowOptions
from tetgan.methods.tetflow.shapes import collate
from tetgan.models.files import load_generator, save_generator
from tetgan.models.sampling import generate_fields

SMALL = {
    "width": 4,
    "base_width": 8,
    "blocks": 1,
    "code": 2,
    "flow_width": 8,
    "flow_layers": 1,
    "flow_heads": 2,
}
OPTIONS = TetflowOptions(kind="tetflow", grid="smoke", flow_steps=2, **SMALL)
HIERARCHY = build_hierarchy(1, 2)


def build(hierarchy=HIERARCHY, seed: int = 0) -> TetflowGenerator:
    torch.manual_seed(seed)
    return TetflowGenerator(OPTIONS, hierarchy).eval()


def ball(hierarchy, radius: float) -> tuple[np.ndarray, np.ndarray]:
    offset = hierarchy.finest.centroids - 0.5
    length = np.linalg.norm(offset, axis=1, keepdims=True)
    return length[:, 0] < radius, ((radius - length) * offset / length).astype(np.float32)


class Oracle(nn.Module):
    """A decoder that knows some shapes."""

    def __init__(self, shapes) -> None:
        super().__init__()
        batch = collate(shapes, torch.device("cpu"))
        sides = 2 * (batch.levels[0].share > 0.5).float() - 1
        self.outputs = []
        for level in batch.levels[:-1]:
            sides = 2 * (level.share > 0.5).float() - 1
            self.outputs.append(torch.stack([sides, 2 * level.split - 1], dim=1))
        self.outputs.append(torch.cat([batch.distance[:, None], 3 * batch.normal], dim=1))

    def start(self, code):
        return torch.zeros(code.shape[0] * code.shape[1], 1)

    def rise(self, number, x):
        return x.repeat(8, 1)

    def level(self, number, x, neighbors):
        assert len(x) == len(neighbors.rows) == len(self.outputs[number])
        return x, self.outputs[number]


@pytest.fixture
def known():
    """A model that decodes two balls, and their fields."""
    model, fields = build(), [ball(HIERARCHY, radius) for radius in (0.2, 0.35)]
    model.autoencoder.decoder = Oracle([model.sets.shape(*field) for field in fields])
    return model, fields


def test_a_known_shape_is_decoded_exactly_where_tets_are_active(known):
    model, fields = known
    decoded = model.decode(torch.zeros(2, *model.latent_shape)).numpy()
    for (occupancy, displacement), found in zip(fields, decoded, strict=True):
        active = model.sets.shape(occupancy, displacement).levels[-1].cells
        np.testing.assert_array_equal(found[:, 0] > 0, occupancy)
        np.testing.assert_allclose(found[active, 1:], displacement[active], atol=1e-3)  # half precision


def test_other_tets_point_to_the_surface_from_no_nearer_than_the_reach(known):
    model, fields = known
    decoded = model.decode(torch.zeros(2, *model.latent_shape)).numpy()
    for (occupancy, displacement), found, radius in zip(fields, decoded, (0.2, 0.35), strict=True):
        far = np.ones(len(occupancy), dtype=bool)
        far[model.sets.shape(occupancy, displacement).levels[-1].cells] = False
        length = np.linalg.norm(found[far, 1:], axis=1)
        assert (length >= (1 - 1e-5) * model.sets.reach).all()
        assert (length >= np.linalg.norm(displacement[far], axis=1) - 1e-3).all()
        ends = HIERARCHY.finest.centroids[far] + found[far, 1:]
        assert np.abs(np.linalg.norm(ends - 0.5, axis=1) - radius).mean() < 0.1 * model.sets.reach


def test_displacements_are_in_units_of_the_longest(known):
    model, fields = known
    one = model.decode(torch.zeros(2, *model.latent_shape))
    model.unit.fill_(2.0)
    assert torch.equal(one[..., 1:], 2 * model.decode(torch.zeros(2, *model.latent_shape))[..., 1:])
    # And encoding takes them so.
    tensor = torch.from_numpy(np.concatenate([fields[0][0][:, None], fields[0][1] / 2], axis=1)).float()
    assert torch.equal(model.encode(tensor[None]), model.encode_shapes([model.sets.shape(*fields[0])]))


def test_own_splits_give_what_the_true_ones_do_where_they_agree():
    model = build()
    code = torch.randn(2, *model.latent_shape, generator=torch.Generator().manual_seed(0))
    for leave in model.autoencoder.decoder.leave[:-1]:
        nn.init.constant_(leave.bias[1:], 100.0)  # all tets are split
    shapes = [model.sets.shape(np.ones(1536, dtype=bool), np.zeros((1536, 3), dtype=np.float32))] * 2
    with torch.no_grad():
        outputs = model.autoencoder.decoder(code, collate(shapes, torch.device("cpu")))
    found = model.descend(code)
    np.testing.assert_array_equal(found.cells, np.arange(2 * 1536))
    np.testing.assert_allclose(found.distance, outputs[-1][:, 0].numpy(), atol=1e-5)


def test_a_batch_decodes_and_encodes_like_its_shapes():
    model = build()
    model.unit.fill_(0.5)
    code = 3 * torch.randn(3, *model.latent_shape, generator=torch.Generator().manual_seed(0))
    with torch.no_grad():
        together = model.decode(code)
        for number in range(3):
            torch.testing.assert_close(
                model.decode(code[number : number + 1])[0], together[number], rtol=1e-4, atol=1e-4
            )
        codes = model.encode(together)
        for number in range(3):
            torch.testing.assert_close(
                model.encode(together[number : number + 1])[0], codes[number], rtol=1e-4, atol=1e-4
            )


def test_nothing_split_is_no_trouble():
    model = build()
    nn.init.constant_(model.autoencoder.decoder.leave[0].bias, -100.0)
    decoded = model.decode(torch.zeros(1, *model.latent_shape))
    assert (decoded[..., 0] < 0).all() and decoded.isfinite().all()
    assert (decoded[..., 1:].norm(dim=-1) >= 1 - 1e-6).all()


@pytest.mark.parametrize("depth", [0, 1, 3])
def test_any_depth(depth):
    hierarchy = build_hierarchy(1, depth)
    model = build(hierarchy)
    occupancy, displacement = ball(hierarchy, 0.3)
    tensor = torch.from_numpy(np.concatenate([occupancy[:, None], displacement], axis=1)).float()[None]
    with torch.no_grad():
        decoded = model.decode(model.encode(tensor))
    assert decoded.shape == tensor.shape and decoded.isfinite().all()


def test_channels_double_from_the_finest_level_up_to_the_most():
    network = Autoencoder(2, 3, code=1, width=24, base_width=128, blocks=2)
    assert [enter.out_features for enter in network.encoder.enter] == [128, 96, 48, 24]
    assert [len(blocks) for blocks in network.encoder.blocks] == [2, 2, 2, 1]
    assert [len(blocks) for blocks in network.decoder.blocks] == [3, 3, 3, 2]


def test_every_weight_takes_part():
    model = build()
    shape = model.sets.shape(*ball(HIERARCHY, 0.3))
    batch = collate([shape], torch.device("cpu"))
    mean, log_variance = model.autoencoder.encoder(batch)
    sum(output.square().sum() for output in model.autoencoder.decoder(mean + log_variance, batch)).backward()
    assert all(p.grad is not None and p.grad.abs().sum() > 0 for p in model.autoencoder.parameters())


def test_a_saved_model_draws_as_before(store, tmp_path):
    model = build(store.hierarchy)
    model.unit.fill_(store.max_displacement)
    save_generator(tmp_path, model, OPTIONS, store.hierarchy)
    loaded = load_generator(tmp_path, store.hierarchy)
    pairs = zip(*(generate_fields(each, store, 2, seed=0) for each in (model, loaded)), strict=True)
    for one, other in pairs:
        np.testing.assert_array_equal(one.occupancy, other.occupancy)
        np.testing.assert_array_equal(one.displacement, other.displacement)


@pytest.mark.parametrize("mode", ["solid", "paper"])
def test_a_decoded_ball_is_meshed_like_its_field(known, mode):
    model, fields = known
    decoded = model.decode(torch.zeros(2, *model.latent_shape)).numpy()
    grid, options = HIERARCHY.finest, MeshingOptions.parse({"mode": mode})
    operator, mu = vertex_operator(grid), 0.02
    for (occupancy, displacement), found in zip(fields, decoded, strict=True):
        pair = Field(occupancy, displacement), Field(found[:, 0] > 0, found[:, 1:])
        exact, ours = (build_solid(field, grid, operator, mu, options, smoothing=False) for field in pair)
        # Away from the active tets feet are shared, which moves few vertices, and those little.
        assert ours.volumes.sum() == pytest.approx(exact.volumes.sum(), rel=0.02)
