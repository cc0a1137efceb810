"""The networks, their optimisers, and the three kinds of step."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import torch
from jaxtyping import Float
from scipy import sparse
from torch import Tensor, nn

from tetgan.grids.hierarchy import GridHierarchy
from tetgan.models.critics import GlobalCritic, LocalCritic
from tetgan.models.options import TetganOptions
from tetgan.models.tetgan import TetganGenerator
from tetgan.nn.rows import RowMap
from tetgan.training.average import WeightAverage
from tetgan.training.loop import Losses
from tetgan.training.losses import (
    as_seen_by_critics,
    displacement_loss,
    gradient_penalty,
    kl_divergence,
    occupancy_loss,
)
from tetgan.training.options import TrainingOptions

BYPASS_NOISE = (
    0.3  # of features whose deviation is near 1: what a bottleneck loses, the decoder must not need
)


class Learner:
    """TetGAN in training.

    All draws come from the generator that each step is given, so a step depends on nothing but the weights,
    the moments of the optimisers and that generator.
    """

    def __init__(
        self,
        options: TetganOptions,
        training: TrainingOptions,
        hierarchy: GridHierarchy,
        vertex_operator: sparse.csr_array,
        *,
        seed: int,
        device: torch.device,
    ) -> None:
        self.training, self.device = training, device
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.generator = TetganGenerator(options, hierarchy).to(device)
            self.critics = self._build_critics(options).to(device)
        self.vertices = RowMap(vertex_operator).to(device)
        self.optimizer = torch.optim.Adam(
            self.generator.parameters(), training.learning_rate, betas=training.betas
        )
        self.critic_optimizer = None
        if len(self.critics) > 0:
            self.critic_optimizer = torch.optim.Adam(
                self.critics.parameters(), training.critic_learning_rate, betas=training.betas
            )
        self.average = WeightAverage(self.generator, training.ema)

    def _build_critics(self, options: TetganOptions) -> nn.ModuleDict:
        maps, critics = self.generator.hierarchy, nn.ModuleDict()
        if self.training.adversarial_start < 1 and self.training.local_weight != 0:
            critics["local"] = LocalCritic(maps, options.local_critic_width)
        if self.training.adversarial_start < 1 and self.training.global_weight != 0:
            critics["global"] = GlobalCritic(maps, options.global_critic_width)
        return critics

    def set_rate(self, factor: float) -> None:
        """Scale the autoencoder's step size; late critics learn at their full rate."""
        self.optimizer.param_groups[0]["lr"] = self.training.learning_rate * factor

    def autoencoder_step(
        self, field: Float[Tensor, "B T 4"], kl_weight: float, draws: torch.Generator
    ) -> Losses:
        """Encode, draw from the posterior, decode, compare; one Adam step on both halves."""
        with self._precision():
            mean, log_variance = self.generator.posterior(field)
            decoded = self.generator.decode(mean + (0.5 * log_variance).exp() * self._noise(mean, draws))
        kl = kl_divergence(mean, log_variance)
        losses = self._reconstruct(decoded, field, kl_weight * kl)
        return losses | {"kl": float(kl.detach())}

    def bypass_step(self, field: Float[Tensor, "B T 4"], draws: torch.Generator) -> Losses:
        """The same around the latent head: features, with some noise, go straight to the decoder."""
        with self._precision():
            features = self.generator.features(field)
            decoded = self.generator.decode_features(features + BYPASS_NOISE * self._noise(features, draws))
        return self._reconstruct(decoded, field, torch.zeros((), device=self.device))

    @torch.no_grad()
    def start_head(self, fields: Iterable[Float[Tensor, "B T 4"]]) -> None:
        """End of the bypass: the latent head starts from the features of these fields."""
        features = torch.cat([self.generator.features(field) for field in fields], dim=1)
        self.generator.head.start_from(features)
        self.average = WeightAverage(self.generator, self.training.ema)

    @torch.no_grad()
    def fit_prior(self, fields: Iterable[Float[Tensor, "B T 4"]]) -> None:
        """Fit the prior, if it is one to be fitted, to the codes of these fields."""
        if self.generator.prior is not None:
            means, log_variances = zip(*map(self.generator.posterior, fields), strict=True)
            self.generator.prior.fit(torch.cat(means), torch.cat(log_variances).exp())

    def _reconstruct(
        self, decoded: Float[Tensor, "B T 4"], field: Float[Tensor, "B T 4"], further: Float[Tensor, ""]
    ) -> Losses:
        """One Adam step towards a better reconstruction and a smaller `further` loss."""
        losses = {
            "occupancy_loss": occupancy_loss(decoded, field, self.training.positive_weight),
            "displacement_loss": displacement_loss(
                self.generator.in_range(decoded), self.generator.in_range(field), self.vertices
            ),
        }
        weighted = self.training.displacement_weight * losses["displacement_loss"]
        self._step_generator(losses["occupancy_loss"] + weighted + further)
        self.average.update()
        return {name: float(loss.detach()) for name, loss in losses.items()}

    def critic_step(self, real: Float[Tensor, "B T 4"], draws: torch.Generator) -> Losses:
        """One WGAN-GP step of both critics: score real fields above decoded draws of the prior."""
        assert self.critic_optimizer is not None
        with torch.no_grad():
            fake = self._fake(len(real), draws)
        real = self.generator.in_range(real)
        share = torch.rand(len(real), generator=draws).to(self.device)
        losses, total = {}, torch.zeros((), device=self.device)
        for name, critic in self.critics.items():
            with self._precision():
                on_real, on_fake = critic(torch.cat([real, fake])).chunk(2)
                penalty = gradient_penalty(critic, real, fake, share)
            gap = (on_real - on_fake).mean()
            total = total - gap + self.training.gradient_penalty * penalty
            losses[f"{name}_gap"], losses[f"{name}_penalty"] = float(gap.detach()), float(penalty.detach())
        self.critic_optimizer.zero_grad()
        total.backward()
        self.critic_optimizer.step()
        return losses

    def adversarial_step(self, count: int, draws: torch.Generator) -> Losses:
        """One Adam step of the decoder towards higher scores of `count` decoded draws of the prior.

        Towards lower ones of a critic whose weight is negative, as in the official code.
        """
        self.critics.requires_grad_(False)
        fake = self._fake(count, draws)
        total = torch.zeros((), device=self.device)
        for name, critic in self.critics.items():
            with self._precision():
                score = critic(fake).mean()
            total = total - getattr(self.training, f"{name}_weight") * score
        self._step_generator(total)
        self.critics.requires_grad_(True)
        return {"adversarial_loss": float(total.detach())}

    def _fake(self, count: int, draws: torch.Generator) -> Float[Tensor, "B T 4"]:
        latent = self.generator.sample_latent(count, draws).to(self.device)
        with self._precision():
            decoded = self.generator.decode(latent)
        return as_seen_by_critics(self.generator.in_range(decoded))

    def _noise(self, like: Tensor, draws: torch.Generator) -> Tensor:
        """Standard normal, drawn on the CPU so that it does not depend on the device."""
        return torch.randn(like.shape, generator=draws).to(self.device)

    def _step_generator(self, loss: Tensor) -> None:
        self.optimizer.zero_grad()
        loss.backward()
        if self.training.gradient_clip is not None:
            nn.utils.clip_grad_norm_(self.generator.parameters(), self.training.gradient_clip)
        self.optimizer.step()

    @contextmanager
    def _precision(self) -> Iterator[None]:
        half = self.training.precision == "bf16"
        with torch.autocast(self.device.type, torch.bfloat16, enabled=half):
            yield

    def parts(self) -> dict[str, Any]:
        """Everything that a checkpoint must hold."""
        parts: dict[str, Any] = {
            "generator": self.generator,
            "optimizer": self.optimizer,
            "average": self.average,
        }
        if self.critic_optimizer is not None:
            parts |= {"critics": self.critics, "critic_optimizer": self.critic_optimizer}
        return parts
