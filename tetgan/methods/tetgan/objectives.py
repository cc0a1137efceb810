"""Losses of TetGAN (paper, section 3.2), all means whatever the sizes."""

from collections.abc import Iterator
from contextlib import contextmanager

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.methods.tetgan.options import TetganTraining
from tetgan.nn.rows import RowMap
from tetgan.training.losses import gradient_penalty, kl_divergence


def occupancy_loss(
    decoded: Float[Tensor, "B T 4"], field: Float[Tensor, "B T 4"], positive_weight: float
) -> Float[Tensor, ""]:
    """Binary cross-entropy; occupied tets count `positive_weight` times."""
    weight = decoded.new_full((), positive_weight)
    return functional.binary_cross_entropy_with_logits(decoded[..., 0], field[..., 0], pos_weight=weight)


def displacement_loss(
    decoded: Float[Tensor, "B T 4"], field: Float[Tensor, "B T 4"], vertices: RowMap
) -> Float[Tensor, ""]:
    """Squared error of the vertex displacements of Eq. 3, per coordinate, in units of the range.

    `vertices` averages tets to vertices; it is linear, so the two fields are averaged as one difference.
    """
    difference = (decoded[..., 1:] - field[..., 1:]).transpose(0, 1)
    return vertices(difference).square().mean()


def relative_displacement_loss(
    decoded: Float[Tensor, "B T 4"], field: Float[Tensor, "B T 4"], vertices: RowMap, mu: float
) -> Float[Tensor, ""]:
    """|ΔD|² / (|D|² + (2μ)²) of the vertex displacements D: far and near ones count alike.

    `mu` is Eq. 5's mean length of the displacement of surface tets, in the unit of the fields.
    """
    true = vertices(field[..., 1:].transpose(0, 1))
    difference = vertices(decoded[..., 1:].transpose(0, 1)) - true
    return (difference.square().sum(dim=-1) / (true.square().sum(dim=-1) + (2 * mu) ** 2)).mean()


def as_seen_by_critics(decoded: Float[Tensor, "B T 4"]) -> Float[Tensor, "B T 4"]:
    """Logits as probabilities, like the 0 and 1 of real fields."""
    return torch.cat([decoded[..., :1].sigmoid(), decoded[..., 1:]], dim=-1)


Objective = tuple[Float[Tensor, ""], dict[str, Tensor]]
"""What to differentiate, and the numbers of the log that it is made of."""


class Objectives(nn.Module):
    """The networks with their losses: a forward pass gives what one backward pass starts from.

    DistributedDataParallel wants it so, and a critic's two terms come apart so that the graph of one is gone
    before the other's is built. All losses are means over the batch, so parts of a batch can be weighed.

    With precision bf16 the networks run under autocast, but for the gradient penalty, a difference of small
    numbers, and the losses.
    """

    def __init__(
        self,
        generator: TetganGenerator,
        critics: nn.ModuleDict,
        vertices: RowMap,
        training: TetganTraining,
        mu: float,
    ) -> None:
        """`mu` is Eq. 5's, in units of the largest displacement, like the displacement of fields."""
        super().__init__()
        self.generator, self.critics, self.vertices = generator, critics, vertices
        self.options, self.mu = training, mu / generator.range

    def forward(self, kind: str, *inputs: object) -> Objective:
        """The objective of a kind, the name of another method."""
        return getattr(self, kind)(*inputs)

    def autoencoder(
        self, field: Float[Tensor, "B T 4"], noise: Float[Tensor, "B ..."], kl_weight: float
    ) -> Objective:
        """Encode, draw from the posterior, decode, compare."""
        with self.autocast():
            mean, log_variance = self.generator.posterior(field)
            decoded = self.generator.decode(mean + (0.5 * log_variance).exp() * noise)
        kl = kl_divergence(mean, log_variance)
        loss, losses = self._reconstruction(decoded, field)
        return loss + kl_weight * kl, losses | {"kl": kl}

    def bypass(self, field: Float[Tensor, "B T 4"], noise: Float[Tensor, "K B C"]) -> Objective:
        """The same around the latent head: features, with some noise, go straight to the decoder."""
        with self.autocast():
            decoded = self.generator.decode_features(self.generator.features(field) + noise)
        return self._reconstruction(decoded, field)

    def _reconstruction(self, decoded: Float[Tensor, "B T 4"], field: Float[Tensor, "B T 4"]) -> Objective:
        occupancy = occupancy_loss(decoded, field, self.options.positive_weight)
        pair = self.generator.in_range(decoded), self.generator.in_range(field)
        if self.options.displacement_loss == "relative":
            displacement = relative_displacement_loss(*pair, self.vertices, self.mu)
        else:
            displacement = displacement_loss(*pair, self.vertices)
        loss = occupancy + self.options.displacement_weight * displacement
        return loss, {"occupancy_loss": occupancy, "displacement_loss": displacement}

    def gap(self, name: str, real: Float[Tensor, "B T 4"], fake: Float[Tensor, "B T 4"]) -> Objective:
        """A critic's score of fakes above that of real ones; norms are of each shape, so one pass does."""
        with self.autocast():
            on_real, on_fake = self.critics[name](torch.cat([real, fake])).chunk(2)
        gap = (on_real - on_fake).mean()
        return -gap, {f"{name}_gap": gap}

    def penalty(
        self,
        name: str,
        real: Float[Tensor, "B T 4"],
        fake: Float[Tensor, "B T 4"],
        share: Float[Tensor, "B"],
    ) -> Objective:
        """A critic's gradient penalty."""
        penalty = gradient_penalty(self.critics[name], real, fake, share)
        return self.options.gradient_penalty * penalty, {f"{name}_penalty": penalty}

    def adversarial(self, latent: Float[Tensor, "B ..."]) -> Objective:
        """The critics' scores of decoded latents, weighed; those of negative weight are made smaller."""
        fake = self.decoded_as_seen(latent)
        total = torch.zeros((), device=fake.device)
        for name, critic in self.critics.items():
            with self.autocast():
                score = critic(fake).mean()
            total = total - getattr(self.options, f"{name}_weight") * score
        return total, {"adversarial_loss": total}

    def decoded_as_seen(self, latent: Float[Tensor, "B ..."]) -> Float[Tensor, "B T 4"]:
        """Decoded latents as critics see them."""
        with self.autocast():
            decoded = self.generator.decode(latent)
        return as_seen_by_critics(self.generator.in_range(decoded))

    @contextmanager
    def autocast(self) -> Iterator[None]:
        device = next(self.generator.parameters()).device.type
        with torch.autocast(device, torch.bfloat16, enabled=self.options.precision == "bf16"):
            yield
