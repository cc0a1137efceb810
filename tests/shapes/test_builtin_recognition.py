"""A public PointNet trained on ModelNet40 recognises the built-in shapes."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from tetgan.shapes.builtin.generate import generate_shape

CHECKPOINT = (
    Path(__file__).parents[3] / "shared/weights/pointnet/learning3d_pointnet_modelnet40_best_model.t7"
)
CLASSES = {"bench": 3, "car": 7, "chair": 8, "sofa": 30, "table": 33, "vase": 37}

pytestmark = pytest.mark.skipif(
    not CHECKPOINT.exists(),
    reason="needs the PointNet checkpoint of ../shared/weights (not part of the repository)",
)


class PointNet(nn.Module):
    """The plain PointNet (no T-Nets) of learning3d, named after its checkpoint's keys."""

    def __init__(self) -> None:
        super().__init__()
        widths = [3, 64, 64, 64, 128, 1024]
        self.feature_model = nn.ModuleDict()
        for layer, (before, after) in enumerate(pairwise(widths), start=1):
            self.feature_model[f"conv{layer}"] = nn.Conv1d(before, after, 1)
            self.feature_model[f"bn{layer}"] = nn.BatchNorm1d(after)
        self.linear1, self.bn1 = nn.Linear(1024, 512), nn.BatchNorm1d(512)
        self.linear2, self.bn2 = nn.Linear(512, 256), nn.BatchNorm1d(256)
        self.linear3 = nn.Linear(256, 40)

    def forward(self, points: torch.Tensor) -> torch.Tensor:
        x = points.transpose(1, 2)
        for layer in range(1, 6):
            x = torch.relu(self.feature_model[f"bn{layer}"](self.feature_model[f"conv{layer}"](x)))
        x = x.max(dim=2).values
        x = torch.relu(self.bn1(self.linear1(x)))
        return self.linear3(torch.relu(self.bn2(self.linear2(x))))


@pytest.fixture(scope="module")
def pointnet() -> PointNet:
    network = PointNet()
    network.load_state_dict(torch.load(CHECKPOINT, weights_only=True, map_location="cpu"))
    return network.eval()


def cloud(category: str, index: int, yaw: float) -> np.ndarray:
    """1,024 area-uniform points about their mean, in the unit sphere, turned by `yaw` degrees about y."""
    shape = generate_shape(category, index, 0)
    corners = shape.vertices[shape.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rng = np.random.default_rng(index)
    chosen = corners[rng.choice(len(areas), 1024, p=areas / areas.sum())]
    root, along = np.sqrt(rng.random(1024))[:, None], rng.random(1024)[:, None]
    points = chosen[:, 0] * (1 - root) + chosen[:, 1] * root * (1 - along) + chosen[:, 2] * root * along
    points -= points.mean(axis=0)
    cosine, sine = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
    turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    return (points / np.linalg.norm(points, axis=1).max()) @ turn.T


# ModelNet40 has no common front: the yaw is the quarter turn that suits a category's models.
@pytest.mark.parametrize(
    ("category", "yaw", "least"),
    [("chair", 180, 0.9), ("sofa", 270, 0.85), ("bench", 180, 0.8), ("car", 90, 0.9), ("vase", 0, 0.8)],
)
def test_pointnet_recognises(pointnet, category, yaw, least):
    points = np.stack([cloud(category, index, yaw) for index in range(60)]).astype(np.float32)
    with torch.inference_mode():
        predicted = pointnet(torch.from_numpy(points)).argmax(dim=1)
    assert (predicted == CLASSES[category]).float().mean() >= least
