"""Training of ShapeGAN's voxel autoencoder."""

from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from tetgan.errors import UserError
from tetgan.methods.shapegan_vae.network import RESOLUTION, ShapeGanVae
from tetgan.methods.shapegan_vae.options import ShapeGanVaeOptions, ShapeGanVaeTraining
from tetgan.models.iou import occupancy_iou
from tetgan.nn.device import pick_device
from tetgan.training.data import VoxelData, VoxelSource
from tetgan.training.learner import Learner, seeded
from tetgan.training.log import Losses
from tetgan.training.losses import kl_divergence


class ShapeGanVaeLearner(Learner):
    """A variational autoencoder: Adam on absolute differences of signed distance, and the KL divergence."""

    generator: ShapeGanVae

    losses = ("reconstruction_loss", "kl", "validation_iou", "validation_difference")

    def __init__(
        self, options: ShapeGanVaeOptions, training: ShapeGanVaeTraining, store: VoxelSource, seed: int
    ) -> None:
        self.training, self.device = training, pick_device(training.device)
        self.epochs, self.batch_size = training.epochs, training.batch_size
        self.data_digest = store.digest
        self.data, self.held_out = VoxelData(store, "train"), VoxelData(store, "validation")
        self.shapes = len(self.data)
        self._check()
        with seeded(seed):
            self.generator = ShapeGanVae(options).to(self.device)
        self.optimizer = torch.optim.Adam(self.generator.parameters(), training.learning_rate)

    def _check(self) -> None:
        if self.data.resolution != RESOLUTION:
            raise UserError(
                f"shapegan-vae: voxels of {self.data.resolution} a side; "
                f"name a sampling of resolution {RESOLUTION}"
            )
        if len(self.data) < 2:
            raise UserError("shapegan-vae: batch norm needs two training shapes at least; add shapes")

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """Encode, draw from the posterior, decode, compare."""
        voxels = self.data.batch(rows, self.device)
        self.generator.train()
        mean, log_variance = self.generator.posterior(voxels)
        noise = torch.randn(mean.shape, generator=draws).to(self.device)
        decoded = self.generator.decode(mean + (0.5 * log_variance).exp() * noise)
        reconstruction = weighted_difference(decoded, voxels, self.training.inside_weight)
        kl = kl_divergence(mean, log_variance)
        self.optimizer.zero_grad()
        (reconstruction + self.training.kl_weight * kl).backward()
        self.optimizer.step()
        return {"reconstruction_loss": float(reconstruction.detach()), "kl": float(kl.detach())}

    @torch.no_grad()
    def validate(self) -> dict[str, float]:
        """IoU of the insides, and absolute difference, of what the posterior mean decodes to."""
        if len(self.held_out) == 0:
            return {}
        self.generator.eval()
        ious, differences = [], []
        for rows in torch.arange(len(self.held_out)).split(self.batch_size):
            voxels = self.held_out.batch(rows, self.device)
            decoded = self.generator.decode(self.generator.posterior(voxels)[0])
            inside = ((part < 0).flatten(1).cpu().numpy() for part in (decoded, voxels))
            ious.append(occupancy_iou(*inside))
            differences.append((decoded - voxels).abs().flatten(1).mean(dim=1).cpu().numpy())
        means = (float(np.concatenate(parts).mean()) for parts in (ious, differences))
        return dict(zip(("validation_iou", "validation_difference"), means, strict=True))

    def parts(self) -> dict[str, Any]:
        return {"generator": self.generator, "optimizer": self.optimizer}


def weighted_difference(
    decoded: Float[Tensor, "B R R R"], voxels: Float[Tensor, "B R R R"], inside_weight: float
) -> Float[Tensor, ""]:
    """Mean absolute difference; voxels inside the true shape count `inside_weight` times."""
    difference = (decoded - voxels).abs()
    return torch.where(voxels < 0, inside_weight * difference, difference).mean()
