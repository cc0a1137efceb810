"""PointNet++ classifier (single-scale grouping, no normals) whose features FID compares.

Qi et al. (2017), "PointNet++: Deep Hierarchical Feature Learning on Point Sets in a Metric Space", the SSG
of their appendix B. Points are centred and scaled to the unit sphere before they come here.
"""

import hashlib
import json
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import torch
from jaxtyping import Float, Int
from safetensors.torch import load_file, save_file
from torch import Tensor, nn
from torch.nn import functional

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.nn.device import device_name

INPUT_POINTS = 1024

FEATURES = 256


class Grouping(NamedTuple):
    """Points that one set abstraction pools, chosen by distances alone, so the same after any rotation."""

    centers: Int[Tensor, "B S"]
    members: Int[Tensor, "B S K"]


class Level(NamedTuple):
    """One grouped set abstraction: `balls` of `radius`, at most `limit` points each."""

    balls: int
    radius: float
    limit: int


LEVELS = (Level(512, 0.2, 32), Level(128, 0.4, 64))


def farthest_points(
    points: Float[Tensor, "B P 3"], count: int, start: Int[Tensor, "B"] | None = None
) -> Int[Tensor, "B S"]:
    """Indices of `count` points, each the farthest from those before it.

    Args:
        points: (B, P, 3) clouds.
        count: how many of the P points to keep.
        start: (B,) the first index of each cloud; 0 when missing.

    Raises:
        ValueError: a cloud has fewer points than asked for.
    """
    batch, size, _ = points.shape
    if count > size:
        raise ValueError(f"cannot keep {count} of {size} points")
    axes = (
        points.detach().permute(2, 0, 1).contiguous()
    )  # long inner axis: the loop below is vectorised over B P
    rows = torch.arange(batch, device=points.device)
    current = torch.zeros_like(rows) if start is None else start.to(torch.long)
    nearest = torch.full((batch, size), torch.inf, dtype=points.dtype, device=points.device)
    chosen = torch.empty((batch, count), dtype=torch.long, device=points.device)
    for step in range(count):
        chosen[:, step] = current
        offset = axes - axes[:, rows, current, None]
        torch.minimum(nearest, offset.square_().sum(0), out=nearest)
        current = nearest.argmax(1)
    return chosen


def ball_query(
    points: Float[Tensor, "B P 3"], centers: Float[Tensor, "B S 3"], radius: float, limit: int
) -> Int[Tensor, "B S K"]:
    """The first `limit` points, in index order, closer than `radius` to each center.

    A ball with fewer repeats its first point, as the original does. Every center must be one of the points,
    so that no ball is empty.
    """
    batch, balls, _ = centers.shape
    distance = torch.cdist(centers, points, compute_mode="donot_use_mm_for_euclid_dist")
    inside = (distance < radius).flatten(0, 1)
    ball, point = inside.nonzero(as_tuple=True)
    sizes = inside.sum(1)
    first = sizes.cumsum(0) - sizes
    rank = torch.arange(len(ball), device=points.device) - first[ball]
    kept = rank < limit
    members = point[first, None].repeat(1, limit)
    members[ball[kept], rank[kept]] = point[kept]
    return members.view(batch, balls, limit)


def prepare_clouds(
    points: Float[Tensor, "B P 3"], start: Int[Tensor, "B"] | None = None
) -> Float[Tensor, "B 1024 3"]:
    """Input of the network: 1,024 farthest-point samples, their mean at the origin, the farthest at 1.

    Raises:
        ValueError: a cloud has fewer points, or all of them in one place.
    """
    chosen = farthest_points(points, INPUT_POINTS, start)
    kept = points.gather(1, chosen[..., None].expand(-1, -1, 3))
    kept = kept - kept.mean(1, keepdim=True)
    radius = kept.norm(dim=2).amax(1)
    if not (radius > 0).all():
        raise ValueError("a cloud has all its points in one place")
    return kept / radius[:, None, None]


def group_points(points: Float[Tensor, "B P 3"]) -> tuple[Grouping, ...]:
    """Centers and balls of every grouped level, each level's indices into the points of the one before."""
    groupings = []
    for level in LEVELS:
        centers = farthest_points(points, level.balls)
        chosen = points.gather(1, centers[..., None].expand(-1, -1, 3))
        groupings.append(Grouping(centers, ball_query(points, chosen, level.radius, level.limit)))
        points = chosen
    return tuple(groupings)


class PointNet2(nn.Module):
    """Classifier of clouds; `features` is what it knows of a shape before it names the class."""

    def __init__(self, classes: int) -> None:
        super().__init__()
        self.level1 = SetAbstraction(0, (64, 64, 128))
        self.level2 = SetAbstraction(128, (128, 128, 256))
        self.whole = SetAbstraction(256, (256, 512, 1024))
        self.head = nn.Sequential(
            nn.Linear(1024, 512),
            nn.BatchNorm1d(512),
            nn.ReLU(),
            nn.Dropout(0.4),
            nn.Linear(512, FEATURES),
            nn.BatchNorm1d(FEATURES),
        )
        self.classify = nn.Sequential(nn.ReLU(), nn.Dropout(0.4), nn.Linear(FEATURES, classes))

    def forward(
        self, points: Float[Tensor, "B P 3"], groupings: tuple[Grouping, ...] | None = None
    ) -> Float[Tensor, "B N"]:
        """Class scores (logits); `groupings` as `group_points` gives them, when the caller has kept them."""
        return self.classify(self.features(points, groupings))

    def features(
        self, points: Float[Tensor, "B P 3"], groupings: tuple[Grouping, ...] | None = None
    ) -> Float[Tensor, "B 256"]:
        """Output of the second fully connected layer, after its batch norm and before its ReLU."""
        first, second = group_points(points) if groupings is None else groupings
        points, channels = self.level1(points, None, first)
        points, channels = self.level2(points, channels, second)
        _, pooled = self.whole(points, channels, None)
        return self.head(pooled[:, 0])


class SetAbstraction(nn.Module):
    """Shared perceptron on every ball, then the maximum over the ball."""

    def __init__(self, channels: int, widths: tuple[int, ...]) -> None:
        super().__init__()
        self.first = nn.Linear(3 + channels, widths[0], bias=False)  # batch norm follows: a bias would cancel
        layers: list[nn.Module] = [nn.BatchNorm1d(widths[0]), nn.ReLU(inplace=True)]
        for before, after in pairwise(widths):
            layers += [nn.Linear(before, after, bias=False), nn.BatchNorm1d(after), nn.ReLU(inplace=True)]
        self.rest = nn.Sequential(*layers)

    def forward(
        self,
        points: Float[Tensor, "B P 3"],
        channels: Float[Tensor, "B P C"] | None,
        grouping: Grouping | None,
    ) -> tuple[Float[Tensor, "B S 3"], Float[Tensor, "B S D"]]:
        """Centers and one feature row per ball; without a grouping one ball at the origin holds everything.

        The first layer is linear in (p - c, f), so it runs once a point and once a center, and the balls
        gather its results: the same sums as one product a member, with a fraction of the arithmetic.
        """
        inputs = points if channels is None else torch.cat([points, channels], dim=2)
        projected = self.first(inputs)
        pool = self._pool if self.training or torch.is_grad_enabled() else self._pool_fixed
        if grouping is None:
            return points.new_zeros(len(points), 1, 3), pool(projected[:, None])
        centers = points.gather(1, grouping.centers[..., None].expand(-1, -1, 3))
        origin = centers @ self.first.weight[:, :3].T
        return centers, pool(_gather_rows(projected, grouping.members) - origin[:, :, None])

    def _pool(self, rows: Float[Tensor, "B S K C"]) -> Float[Tensor, "B S D"]:
        return self.rest(rows.flatten(0, 2)).unflatten(0, rows.shape[:3]).max(2).values

    def _pool_fixed(self, rows: Float[Tensor, "B S K C"]) -> Float[Tensor, "B S D"]:
        """The same to rounding, in half the time, where nothing is learned: batch norms join the layers."""
        norm, _, *others = self.rest
        flat = functional.relu_(norm(rows.flatten(0, 2)))
        for linear, following in zip(others[::3], others[1::3], strict=True):
            flat = functional.relu_(functional.linear(flat, *_fold(linear, following)))
        return flat.unflatten(0, rows.shape[:3]).amax(2)


def _fold(linear: nn.Module, norm: nn.Module) -> tuple[Float[Tensor, "D C"], Float[Tensor, "D"]]:
    """Weight and bias of a layer without bias and the batch norm after it, whose statistics are fixed."""
    assert isinstance(linear, nn.Linear)
    assert isinstance(norm, nn.BatchNorm1d)
    assert norm.running_mean is not None
    assert norm.running_var is not None
    scale = norm.weight / (norm.running_var + norm.eps).sqrt()
    return linear.weight * scale[:, None], norm.bias - norm.running_mean * scale


def _gather_rows(rows: Float[Tensor, "B P C"], members: Int[Tensor, "B S K"]) -> Float[Tensor, "B S K C"]:
    """Rows of every ball's members, looked up as embeddings: their backward is deterministic everywhere."""
    batch, size, _ = rows.shape
    offset = torch.arange(batch, device=rows.device)[:, None, None] * size
    return functional.embedding(members + offset, rows.flatten(0, 1))


class Classifier(NamedTuple):
    """A trained network with its digest, categories and accuracy."""

    network: PointNet2
    categories: tuple[str, ...]
    accuracy: float
    digest: str


def save_classifier(folder: Path, network: PointNet2, about: dict[str, Any]) -> None:
    """Write `weights.safetensors` and `options.json`: the device, and `about`.

    `about` holds `categories` and `holdout_accuracy`.
    """
    about = {**about, "device": device_name(next(network.parameters()).device)}
    tensors = {name: tensor.detach().cpu().contiguous() for name, tensor in network.state_dict().items()}
    with whole_file(folder / "options.json") as partial:
        partial.write_text(json.dumps(about, indent=1) + "\n")
    with whole_file(folder / "weights.safetensors") as partial:
        save_file(tensors, partial)


def load_classifier(folder: Path, device: torch.device | str = "cpu") -> Classifier:
    """Read what `save_classifier` wrote; the digest is the first 12 hex digits of the weights' sha256.

    Raises:
        UserError: the folder does not hold such a classifier.
    """
    weights = Path(folder) / "weights.safetensors"
    try:
        about = json.loads((Path(folder) / "options.json").read_text())
        network = PointNet2(len(about["categories"]))
        network.load_state_dict(load_file(weights))
        digest = hashlib.sha256(weights.read_bytes()).hexdigest()[:12]
        accuracy = float(about["holdout_accuracy"])
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        reason = str(error).splitlines()[0]
        raise UserError(f"{folder}: not a folder of a trained PointNet++ classifier ({reason})") from None
    return Classifier(network.to(device).eval(), tuple(about["categories"]), accuracy, digest)
