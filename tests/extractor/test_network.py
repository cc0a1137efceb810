"""PointNet++: its groupings against naive loops, its layers against the textbook order."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from tetgan.errors import UserError
from tetgan.extractor.network import (
    PointNet2,
    ball_query,
    farthest_points,
    group_points,
    load_classifier,
    prepare_clouds,
    save_classifier,
)


def cloud(seed: int, batch: int, size: int) -> torch.Tensor:
    return torch.rand(batch, size, 3, generator=torch.Generator().manual_seed(seed))


def farthest_by_loop(points: np.ndarray, count: int, start: int) -> list[int]:
    chosen = [start]
    while len(chosen) < count:
        gaps = [min(((point - points[c]) ** 2).sum() for c in chosen) for point in points]
        chosen.append(int(np.argmax(gaps)))
    return chosen


def ball_by_loop(points: np.ndarray, center: np.ndarray, radius: float, limit: int) -> list[int]:
    inside = [i for i, point in enumerate(points) if np.linalg.norm(point - center) < radius][:limit]
    return inside + inside[:1] * (limit - len(inside))


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**31), size=st.integers(2, 20), start=st.integers(0, 1))
def test_farthest_points_agree_with_a_loop(seed, size, start):
    points = cloud(seed, 2, size)
    got = farthest_points(points, size // 2 + 1, torch.tensor([start, 0]))
    for row, first, found in zip(points.numpy(), (start, 0), got.tolist(), strict=True):
        assert found == farthest_by_loop(row, size // 2 + 1, first)


def test_farthest_points_of_a_line():
    # From one end: the other end, then the middle, then a quarter (the first of two).
    points = torch.zeros(1, 5, 3)
    points[0, :, 0] = torch.arange(5.0)
    assert farthest_points(points, 4).tolist() == [[0, 4, 2, 1]]


def test_farthest_points_of_farthest_points_are_the_first():
    points = cloud(0, 2, 200)
    chosen = farthest_points(points, 60)
    kept = points.gather(1, chosen[..., None].expand(-1, -1, 3))
    assert farthest_points(kept, 20).tolist() == [list(range(20))] * 2


def test_more_points_than_there_are_cannot_be_kept():
    with pytest.raises(ValueError, match="cannot keep 5 of 4"):
        farthest_points(cloud(0, 1, 4), 5)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**31), radius=st.floats(0.01, 2), limit=st.integers(1, 12))
def test_ball_query_agrees_with_a_loop(seed, radius, limit):
    points = cloud(seed, 2, 15)
    centers = points[:, :4]
    got = ball_query(points, centers, radius, limit)
    for row, around, found in zip(points.numpy(), centers.numpy(), got.tolist(), strict=True):
        assert found == [ball_by_loop(row, center, radius, limit) for center in around]


def test_groupings_do_not_change_when_a_cloud_is_turned():
    points = prepare_clouds(cloud(3, 1, 1200))
    turned = torch.stack([-points[..., 0], points[..., 1], -points[..., 2]], dim=2)  # half a turn is exact
    for before, after in zip(group_points(points), group_points(turned), strict=True):
        assert torch.equal(before.centers, after.centers)
        assert torch.equal(before.members, after.members)


def test_prepared_clouds_touch_the_unit_sphere_about_their_mean():
    points = prepare_clouds(5 * cloud(1, 2, 1100) + 3)
    assert points.shape == (2, 1024, 3)
    # float32 sums over 1,024 points
    torch.testing.assert_close(points.mean(1), torch.zeros(2, 3), atol=1e-6, rtol=0)
    torch.testing.assert_close(points.norm(dim=2).amax(1), torch.ones(2))


def test_a_cloud_in_one_place_is_refused():
    with pytest.raises(ValueError, match="one place"):
        prepare_clouds(torch.ones(1, 1024, 3))


def test_first_layer_before_gathering_equals_after():
    # The textbook order: gather, subtract the center, concatenate, then one linear layer.
    network = PointNet2(2).eval()
    level, points = network.level2, cloud(4, 2, 512)
    channels = torch.rand(2, 512, 128, generator=torch.Generator().manual_seed(5))
    grouping = group_points(prepare_clouds(cloud(6, 2, 1024)))[1]
    with torch.no_grad():
        centers, got = level(points, channels, grouping)
        batch = torch.arange(2)[:, None, None]
        relative = points[batch, grouping.members] - centers[:, :, None]
        rows = torch.cat([relative, channels[batch, grouping.members]], dim=3)
        expected = level.rest(level.first(rows).flatten(0, 2)).unflatten(0, rows.shape[:3]).amax(2)
    # float32 sums of 131 terms in another order
    torch.testing.assert_close(got, expected, atol=1e-5, rtol=1e-4)


def test_features_of_a_cloud_do_not_depend_on_its_neighbours_in_a_batch():
    network = PointNet2(3).eval()
    points = prepare_clouds(cloud(7, 3, 1024))
    with torch.no_grad():
        together = network.features(points)
        assert together.shape == (3, 256)
        # float32 sums, blocked differently for another number of rows
        torch.testing.assert_close(network.features(points[1:2]), together[1:2], atol=1e-5, rtol=1e-4)


def test_features_without_gradients_equal_those_with():
    # Without gradients batch norms are folded into the layers: statistics away from 0 and 1 tell.
    network = PointNet2(3)
    generator = torch.Generator().manual_seed(0)
    for module in network.modules():
        if isinstance(module, torch.nn.BatchNorm1d):
            for tensor in (module.running_mean, module.running_var, module.weight, module.bias):
                tensor.data.copy_(torch.rand(tensor.shape, generator=generator) + 0.5)
    network.eval()
    points = prepare_clouds(cloud(10, 2, 1024))
    expected = network.features(points).detach()
    with torch.no_grad():
        # float32 products of up to 1,024 terms, scaled before rather than after
        torch.testing.assert_close(network.features(points), expected, atol=1e-4, rtol=1e-4)


def test_layers_have_the_published_sizes():
    # [64,64,128], [128,128,256], [256,512,1024], 512-256-classes; convolutions have no bias.
    network = PointNet2(40)
    convolutions = [(3, 64), (64, 64), (64, 128), (131, 128), (128, 128), (128, 256), (259, 256), (256, 512)]
    convolutions += [(512, 1024)]
    expected = sum(a * b + 2 * b for a, b in convolutions)
    expected += sum(a * b + b + 2 * b for a, b in [(1024, 512), (512, 256)]) + 256 * 40 + 40
    assert sum(parameter.numel() for parameter in network.parameters()) == expected


def test_training_is_deterministic():
    points, labels = prepare_clouds(cloud(8, 2, 1024)), torch.tensor([0, 1])
    gradients = []
    for _ in range(2):
        torch.manual_seed(0)
        network = PointNet2(2)
        torch.nn.functional.cross_entropy(network(points), labels).backward()
        gradients.append([parameter.grad for parameter in network.parameters()])
    assert all(torch.equal(one, other) for one, other in zip(*gradients, strict=True))


def test_a_saved_classifier_loads_with_the_same_digest(tmp_path):
    network = PointNet2(2).eval()
    save_classifier(tmp_path, network, {"categories": ["chair", "sofa"], "holdout_accuracy": 0.5})
    loaded = load_classifier(tmp_path)
    assert loaded.categories == ("chair", "sofa")
    assert loaded.digest == load_classifier(tmp_path).digest
    assert len(loaded.digest) == 12
    points = prepare_clouds(cloud(9, 1, 1024))
    with torch.no_grad():
        assert torch.equal(loaded.network.features(points), network.features(points))


def test_a_folder_without_a_classifier_says_so(tmp_path):
    with pytest.raises(UserError, match="not a folder of a trained"):
        load_classifier(tmp_path)
