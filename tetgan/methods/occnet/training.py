"""Training of OccNet."""

from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor
from torch.nn import functional

from tetgan.methods.occnet.network import OccNetGenerator
from tetgan.methods.occnet.options import OccNetOptions, OccNetTraining
from tetgan.models.iou import occupancy_iou
from tetgan.nn.device import pick_device
from tetgan.training.data import PointData, PointSource
from tetgan.training.learner import Learner, seeded
from tetgan.training.log import Losses


class OccNetLearner(Learner):
    """A variational autoencoder: Adam on the evidence bound of the occupancy at random points."""

    generator: OccNetGenerator

    losses = ("reconstruction_loss", "kl", "validation_iou", "validation_accuracy")

    def __init__(
        self, options: OccNetOptions, training: OccNetTraining, store: PointSource, seed: int
    ) -> None:
        self.training, self.device = training, pick_device(training.device)
        self.epochs, self.batch_size = training.epochs, training.batch_size
        self.data_digest = store.digest
        self.data, self.held_out = PointData(store, "train"), PointData(store, "validation")
        self.shapes = len(self.data)
        with seeded(seed):
            self.generator = OccNetGenerator(options).to(self.device)
        self.generator.encoded.fill_(training.points)
        self.optimizer = torch.optim.Adam(self.generator.parameters(), training.learning_rate)

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """One step on random points, which are both encoded and decoded."""
        data = self.data.random(rows, self.training.points, draws, self.device)
        mean, log_variance = self.generator.posterior(data)
        noise = torch.randn(mean.shape, generator=draws).to(self.device)
        logits = self.generator.value(mean + (0.5 * log_variance).exp() * noise, data[..., :3])
        reconstruction, kl = bound(logits, data[..., 3], mean, log_variance)
        self.optimizer.zero_grad()
        (reconstruction + kl).backward()
        self.optimizer.step()
        return {"reconstruction_loss": float(reconstruction.detach()), "kl": float(kl.detach())}

    @torch.no_grad()
    def validate(self) -> dict[str, float]:
        """IoU and share of right answers at the first points of each shape, which are encoded, too."""
        if len(self.held_out) == 0:
            return {}
        ious, right = [], []
        for rows in torch.arange(len(self.held_out)).split(self.batch_size):
            data = self.held_out.first(rows, self.training.points, self.device)
            values = self.generator.value(self.generator.encode(data), data[..., :3])
            decoded, true = (values > self.generator.level).cpu().numpy(), data[..., 3].cpu().numpy() > 0.5
            ious.append(occupancy_iou(decoded, true))
            right.append((decoded == true).mean(axis=1))
        means = (float(np.concatenate(parts).mean()) for parts in (ious, right))
        return dict(zip(("validation_iou", "validation_accuracy"), means, strict=True))

    def parts(self) -> dict[str, Any]:
        return {"generator": self.generator, "optimizer": self.optimizer}


def bound(
    logits: Float[Tensor, "B N"],
    occupancy: Float[Tensor, "B N"],
    mean: Float[Tensor, "B Z"],
    log_variance: Float[Tensor, "B Z"],
) -> tuple[Float[Tensor, ""], Float[Tensor, ""]]:
    """Cross-entropy summed over points, and KL divergence summed over the code; means over the batch."""
    entropy = functional.binary_cross_entropy_with_logits(logits, occupancy, reduction="none")
    kl = 0.5 * (mean.square() + log_variance.exp() - 1 - log_variance)
    return entropy.sum(dim=1).mean(), kl.sum(dim=1).mean()
