"""Training of ShapeGAN with its growing critic."""

from itertools import accumulate
from typing import Any

import torch
from jaxtyping import Float, Int
from torch import Tensor
from torch.utils.checkpoint import checkpoint

from tetgan.errors import UserError
from tetgan.fields.voxels import cell_centres
from tetgan.methods.shapegan.network import RESOLUTIONS, ShapeGanGenerator, VoxelCritic
from tetgan.methods.shapegan.options import ShapeGanOptions, ShapeGanTraining
from tetgan.nn.device import pick_device
from tetgan.training.data import VoxelData, VoxelSource
from tetgan.training.learner import Learner, seeded
from tetgan.training.log import Losses
from tetgan.training.losses import gradient_penalty

POINTS = 2**15  # that the generator answers at a time; more only takes memory


class ShapeGanLearner(Learner):
    """WGAN-GP by RMSprop, from 8³ voxels up to the resolution of the data."""

    generator: ShapeGanGenerator

    losses = ("resolution", "fade", "gap", "penalty", "adversarial_loss")

    def __init__(
        self, options: ShapeGanOptions, training: ShapeGanTraining, store: VoxelSource, seed: int
    ) -> None:
        self.training, self.device = training, pick_device(training.device)
        self.data_digest = store.digest
        self.data = VoxelData(store, "train")
        self.stages = stages(self.data.resolution, training.epochs)
        self.epochs, self.batch_size = sum(epochs for _, epochs in self.stages), training.batch_size
        self.shapes = len(self.data)
        with seeded(seed):
            self.generator = ShapeGanGenerator(options).to(self.device)
            self.critic = VoxelCritic().to(self.device)
        self.optimizer = torch.optim.RMSprop(self.generator.parameters(), training.learning_rate)
        self.critic_optimizer = torch.optim.RMSprop(self.critic.parameters(), training.learning_rate)

    def take_step(self, rows: Int[Tensor, "B"], step: int, epoch: float, draws: torch.Generator) -> Losses:
        """One step of the critic, and every few of them one of the generator."""
        resolution, fade = stage_at(epoch, self.stages, self.training.fade_in)
        losses = self.critic_step(self.data.batch(rows, self.device, resolution), fade, draws)
        if (step + 1) % self.training.critic_steps == 0:
            losses |= self.generator_step(len(rows), resolution, fade, draws)
        return losses | {"resolution": float(resolution), "fade": fade}

    def critic_step(self, real: Float[Tensor, "B R R R"], fade: float, draws: torch.Generator) -> Losses:
        """Score real voxels above generated ones."""
        with torch.no_grad():
            fake = self._fake(len(real), real.shape[-1], draws)
        share = torch.rand(len(real), generator=draws).to(self.device)
        on_real, on_fake = self.critic(torch.cat([real, fake]), fade).chunk(2)
        gap = (on_real - on_fake).mean()
        penalty = gradient_penalty(lambda voxels: self.critic(voxels, fade), real, fake, share)
        self.critic_optimizer.zero_grad()
        (self.training.gradient_penalty * penalty - gap).backward()
        self.critic_optimizer.step()
        return {"gap": float(gap.detach()), "penalty": float(penalty.detach())}

    def generator_step(self, count: int, resolution: int, fade: float, draws: torch.Generator) -> Losses:
        """Raise the scores of `count` generated shapes."""
        self.critic.requires_grad_(False)
        loss = -self.critic(self._fake(count, resolution, draws), fade).mean()
        self.optimizer.zero_grad()
        loss.backward()
        self.optimizer.step()
        self.critic.requires_grad_(True)
        return {"adversarial_loss": float(loss.detach())}

    def _fake(self, count: int, resolution: int, draws: torch.Generator) -> Float[Tensor, "B R R R"]:
        """Generated voxels. For a gradient the network is evaluated twice rather than all of it kept."""
        latents = torch.randn(count, *self.generator.latent_shape, generator=draws).to(self.device)
        points = torch.from_numpy(cell_centres(resolution).reshape(-1, 3)).float().to(self.device)
        shapes = [
            checkpoint(self._distances, some, points, use_reentrant=False, preserve_rng_state=False)
            for some in latents.split(max(1, POINTS // len(points)))
        ]
        return torch.cat(shapes).unflatten(1, 3 * (resolution,))

    def _distances(self, latents: Float[Tensor, "B Z"], points: Float[Tensor, "N 3"]) -> Float[Tensor, "B N"]:
        return self.generator.clamped_distance(latents, points.expand(len(latents), -1, -1))

    def parts(self) -> dict[str, Any]:
        return {
            "generator": self.generator,
            "optimizer": self.optimizer,
            "critic": self.critic,
            "critic_optimizer": self.critic_optimizer,
        }


def stages(resolution: int, epochs: int | list[int]) -> list[tuple[int, int]]:
    """Each resolution up to that of the data, and its epochs.

    Raises:
        UserError: the critic cannot grow to the resolution, or the epochs are not one number for each.
    """
    if resolution not in RESOLUTIONS:
        raise UserError(f"shapegan-gan: voxels of {resolution} a side; name a sampling of 8 to 64")
    grown = [size for size in RESOLUTIONS if size <= resolution]
    of_each = epochs if isinstance(epochs, list) else len(grown) * [epochs]
    if len(of_each) != len(grown):
        raise UserError(f"training.epochs: {len(of_each)} numbers for resolutions {grown}; give one for each")
    return list(zip(grown, of_each, strict=True))


def stage_at(epoch: float, stages: list[tuple[int, int]], fade_in: float) -> tuple[int, float]:
    """Resolution after `epoch` epochs, and how far it is blended in, 0 to 1; the first is there at once."""
    resolutions, ends = [size for size, _ in stages], list(accumulate(epochs for _, epochs in stages))
    stage = sum(epoch >= end for end in ends[:-1])
    if stage == 0 or fade_in == 0:
        return resolutions[stage], 1.0
    return resolutions[stage], min(1.0, (epoch - ends[stage - 1]) / fade_in)
