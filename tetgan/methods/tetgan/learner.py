"""TetGAN's networks, their optimisers, and the three kinds of step."""

from collections.abc import Iterable
from itertools import chain
from typing import Any, NamedTuple

import torch
from jaxtyping import Float
from scipy import sparse
from torch import Tensor, nn

from tetgan.grids.hierarchy import GridHierarchy
from tetgan.methods.tetgan.critics import GlobalCritic, LocalCritic
from tetgan.methods.tetgan.network import TetganGenerator, use_checkpointing
from tetgan.methods.tetgan.objectives import Objectives
from tetgan.methods.tetgan.options import TetganOptions, TetganTraining
from tetgan.nn.rows import RowMap
from tetgan.training.average import WeightAverage
from tetgan.training.log import Losses
from tetgan.training.processes import Share, exchanging, joined, mean_over_processes, shares

# Of features whose deviation is near 1: what a bottleneck loses, the decoder must not need.
BYPASS_NOISE = 0.3


class Term(NamedTuple):
    """A part of what a step makes smaller: an objective, what it is of, and its weight."""

    weight: float
    kind: str
    inputs: tuple[Any, ...]


class TetganLearner:
    """TetGAN in training.

    All draws come from the generator that each step is given, so a step depends on nothing but the weights,
    the moments of the optimisers and that generator.
    """

    def __init__(
        self,
        options: TetganOptions,
        training: TetganTraining,
        hierarchy: GridHierarchy,
        vertex_operator: sparse.csr_array,
        *,
        mu: float,
        seed: int,
        device: torch.device,
    ) -> None:
        """`mu` is Eq. 5's mean displacement of surface tets over the largest displacement."""
        self.training, self.device = training, device
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.generator = TetganGenerator(options, hierarchy).to(device)
            self.critics = self._build_critics(options).to(device)
        self.vertices = RowMap(vertex_operator).to(device)
        self.objectives = Objectives(self.generator, self.critics, self.vertices, training, mu)
        if training.checkpointing:
            use_checkpointing(self.objectives)
        self._joined = joined(self.objectives)
        self.optimizer = self._adam(self.generator, training.learning_rate, training.betas)
        self.critic_optimizer = self.adversarial_optimizer = None
        if len(self.critics) > 0:
            self.critic_optimizer = self._adam(self.critics, training.critic_learning_rate, training.betas)
            # Moments of its own: with the autoencoder's, a step would follow their momentum, not the critics.
            self.adversarial_optimizer = self._adam(
                self.generator, self.adversarial_rate, training.adversarial_betas
            )
        self._autoencoder_norm: Tensor | None = None
        self.average = WeightAverage(self.generator, training.ema)

    def _build_critics(self, options: TetganOptions) -> nn.ModuleDict:
        maps, critics = self.generator.hierarchy, nn.ModuleDict()
        if self.training.adversarial_start < 1 and self.training.local_weight != 0:
            critics["local"] = LocalCritic(maps, options.local_critic_width)
        if self.training.adversarial_start < 1 and self.training.global_weight != 0:
            critics["global"] = GlobalCritic(maps, options.global_critic_width)
        return critics

    def _adam(self, module: nn.Module, rate: float, betas: tuple[float, float]) -> torch.optim.Adam:
        """Fused: one pass over all weights and moments."""
        return torch.optim.Adam(module.parameters(), rate, betas=betas, fused=True)

    def set_rate(self, factor: float) -> None:
        """Scale the step sizes of both optimisers of the generator; critics learn at their full rate."""
        self.optimizer.param_groups[0]["lr"] = self.training.learning_rate * factor
        if self.adversarial_optimizer is not None:
            self.adversarial_optimizer.param_groups[0]["lr"] = self.adversarial_rate * factor

    @property
    def adversarial_rate(self) -> float:
        """Step size of the adversarial step before the schedule.

        Adam divides by the gradient's size: the critics' weights set their shares of a step, not its length.
        """
        return self.training.adversarial_learning_rate or self.training.learning_rate

    def autoencoder_step(
        self,
        field: Float[Tensor, "B T 4"],
        kl_weight: float,
        draws: torch.Generator,
        *,
        of: int | None = None,
    ) -> Losses:
        """Encode, draw from the posterior, decode, compare; one Adam step on both halves.

        Here and below, where several processes share a batch, `field` is this one's part of a batch of `of`
        shapes.
        """
        count = of or len(field)
        noise = torch.randn(count, *self.generator.latent_shape, generator=draws)
        return self._step_autoencoder(
            Term(share.weight, "autoencoder", (field[share.own], self._put(noise[share.rows]), kl_weight))
            for share in self._shares(count)
        )

    def bypass_step(
        self, field: Float[Tensor, "B T 4"], draws: torch.Generator, *, of: int | None = None
    ) -> Losses:
        """The same around the latent head: features, with some noise, go straight to the decoder."""
        count = of or len(field)
        tets, channels = self.generator.head.unfolded
        noise = BYPASS_NOISE * torch.randn(tets, count, channels, generator=draws)
        return self._step_autoencoder(
            Term(share.weight, "bypass", (field[share.own], self._put(noise[:, share.rows])))
            for share in self._shares(count)
        )

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

    def critic_step(
        self, field: Float[Tensor, "B T 4"], draws: torch.Generator, *, of: int | None = None
    ) -> Losses:
        """One WGAN-GP step of both critics: score real fields above decoded draws of the prior."""
        assert self.critic_optimizer is not None
        count = of or len(field)
        cut = self._shares(count)
        latent, mix = self.generator.sample_latent(count, draws), torch.rand(count, generator=draws)
        with torch.no_grad():
            fake = torch.cat([self.objectives.decoded_as_seen(self._put(latent[s.rows])) for s in cut])
        real = self.generator.in_range(field)
        terms = []
        for share in cut:
            pair = real[share.own], fake[share.own]
            for name in self.critics:
                terms.append(Term(share.weight, "gap", (name, *pair)))
                terms.append(Term(share.weight, "penalty", (name, *pair, self._put(mix[share.rows]))))
        losses = self._differentiate(self.critic_optimizer, terms)
        self.critic_optimizer.step()
        return losses

    def adversarial_step(self, count: int, draws: torch.Generator) -> Losses:
        """One Adam step of the decoder alone towards higher scores of `count` decoded draws of the prior.

        Towards lower ones of a critic whose weight is negative, as in the official code. `adversarial_ratio`
        is the norm of the decoder's gradient over that of the last autoencoder step.
        """
        assert self.adversarial_optimizer is not None
        latent = self.generator.sample_latent(count, draws)
        self.critics.requires_grad_(False)
        terms = (
            Term(share.weight, "adversarial", (self._put(latent[share.rows]),))
            for share in self._shares(count)
        )
        losses, norm = self._step_generator(self.adversarial_optimizer, terms)
        self.critics.requires_grad_(True)
        if self._autoencoder_norm is None:
            return losses
        return losses | {"adversarial_ratio": norm / self._autoencoder_norm}

    def _shares(self, count: int) -> list[Share]:
        return shares(count, self.training.accumulate)

    def _put(self, values: Tensor) -> Tensor:
        """Move what was drawn on the CPU, so that it does not depend on the device, without waiting."""
        if self.device.type == "cuda" and values.device.type == "cpu":
            values = values.pin_memory()
        return values.to(self.device, non_blocking=True)

    def _step_autoencoder(self, terms: Iterable[Term]) -> Losses:
        losses, self._autoencoder_norm = self._step_generator(self.optimizer, terms)
        self.average.update()
        return losses

    def _step_generator(
        self, optimizer: torch.optim.Optimizer, terms: Iterable[Term]
    ) -> tuple[Losses, Tensor]:
        """One step; the losses, and the norm of the decoder's gradient before it is clipped."""
        losses = self._differentiate(optimizer, terms)
        generator = self.generator
        both = chain(generator.decoder.parameters(), generator.head.expand.parameters())
        norm = nn.utils.get_total_norm([p.grad for p in both if p.grad is not None])
        if self.training.gradient_clip is not None:
            nn.utils.clip_grad_norm_(generator.parameters(), self.training.gradient_clip)
        optimizer.step()
        return losses, norm

    def _differentiate(self, optimizer: torch.optim.Optimizer, terms: Iterable[Term]) -> Losses:
        """Gradients of a sum of terms, one after the other: the graph of one is in memory at a time."""
        optimizer.zero_grad()
        listed, losses = list(terms), dict[str, Tensor]()
        for term in listed:
            with exchanging(self._joined, term is listed[-1]):
                loss, parts = self._joined(term.kind, *term.inputs)
                (term.weight * loss).backward()
            for name, value in parts.items():
                losses[name] = losses.get(name, 0) + term.weight * value.detach()
        return mean_over_processes(losses)

    def parts(self) -> dict[str, Any]:
        """Everything that a checkpoint must hold."""
        parts: dict[str, Any] = {
            "generator": self.generator,
            "optimizer": self.optimizer,
            "average": self.average,
        }
        if self.critic_optimizer is not None:
            parts |= {"critics": self.critics, "critic_optimizer": self.critic_optimizer}
            parts["adversarial_optimizer"] = self.adversarial_optimizer
        return parts
