"""Plain form of a training iteration, the baseline of the benchmarks.

Features are (B, T, C); a convolution pads, indexes, reshapes and multiplies once; normalisation and
activation are PyTorch's InstanceNorm1d and LeakyReLU; critics see real fields, fakes and those in between one
after the other, fakes with the graph that made them, and the generator's step fills the critics' gradients as
well; Adam goes through the parameters one by one. The networks take over the weights of ours.
"""

import numpy as np
import torch
from naive import around, linear_form, naive_tet_conv
from scipy import sparse
from torch import Tensor, nn
from torch.nn import functional

from tetgan.grids.hierarchy import GridHierarchy, upsampling_weights
from tetgan.methods.tetgan.critics import GlobalCritic, LocalCritic
from tetgan.methods.tetgan.learner import TetganLearner
from tetgan.methods.tetgan.network import TetganGenerator
from tetgan.nn.conv import TetConv
from tetgan.nn.norm import SLOPE, TetInstanceNorm
from tetgan.nn.resample import TetPool, TetUpsample


class NaiveConv(nn.Module):
    def __init__(self, conv: TetConv, neighbors: Tensor) -> None:
        super().__init__()
        self.weight = nn.Parameter(linear_form(conv.weight.detach()).clone())
        self.bias = None if conv.bias is None else nn.Parameter(conv.bias.detach().clone())
        self.neighbors = neighbors

    def forward(self, x: Tensor) -> Tensor:
        return naive_tet_conv(x, self.weight, self.bias, self.neighbors)


class NaiveNorm(nn.Module):
    def __init__(self, channels: int) -> None:
        super().__init__()
        self.norm, self.activation = nn.InstanceNorm1d(channels), nn.LeakyReLU(SLOPE)

    def forward(self, x: Tensor) -> Tensor:
        return self.activation(self.norm(x.transpose(1, 2)).transpose(1, 2))


class NaivePool(nn.Module):
    def forward(self, x: Tensor) -> Tensor:
        return x.unflatten(1, (-1, 8)).max(dim=2).values


class NaiveUpsample(nn.Module):
    """Each child averages its parent and the parent's neighbors."""

    def __init__(self, weights: np.ndarray, neighbors: Tensor) -> None:
        super().__init__()
        self.weights, self.neighbors = torch.from_numpy(weights).float(), neighbors

    def forward(self, x: Tensor) -> Tensor:
        padded = functional.pad(x, (0, 0, 0, 1))
        return torch.einsum("tks,btsc->btkc", self.weights, padded[:, self.neighbors]).flatten(1, 2)


class NaiveLayers(nn.Module):
    """The layers of one of our networks, in the plain form; `level` is that of the grid they start on."""

    def __init__(self, ours: nn.Module, hierarchy: GridHierarchy, level: int) -> None:
        super().__init__()
        around_each = [around(grid.neighbors) for grid in hierarchy.levels]
        layers: list[nn.Module] = []
        channels = 0
        for layer in _flat(ours):
            if isinstance(layer, TetConv):
                layers.append(NaiveConv(layer, around_each[level]))
                channels = layer.weight.shape[-1]
            elif isinstance(layer, TetInstanceNorm):
                layers.append(NaiveNorm(channels))
            elif isinstance(layer, TetPool):
                layers.append(NaivePool())
                level -= 1
            else:
                weights = upsampling_weights(*hierarchy.levels[level : level + 2])
                layers.append(NaiveUpsample(weights, around_each[level]))
                level += 1
        self.layers = nn.Sequential(*layers)

    def forward(self, x: Tensor) -> Tensor:
        return self.layers(x)


def _flat(module: nn.Module) -> list[nn.Module]:
    """The layers in order, out of all sequences inside each other."""
    if isinstance(module, TetConv | TetInstanceNorm | TetPool | TetUpsample):
        return [module]
    return [layer for child in module.children() for layer in _flat(child)]


class NaiveGenerator(nn.Module):
    def __init__(self, ours: TetganGenerator, hierarchy: GridHierarchy) -> None:
        super().__init__()
        self.encoder = NaiveLayers(ours.encoder, hierarchy, hierarchy.depth)
        self.decoder = NaiveLayers(ours.decoder, hierarchy, 0)
        for name in ("hidden", "mean", "log_variance", "expand"):
            theirs = getattr(ours.head, name)
            layer = nn.Linear(theirs.in_features, theirs.out_features)
            layer.load_state_dict(theirs.state_dict())
            setattr(self, name, layer)

    def posterior(self, field: Tensor) -> tuple[Tensor, Tensor]:
        hidden = functional.leaky_relu(self.hidden(self.encoder(field)), SLOPE)
        return self.mean(hidden), self.log_variance(hidden)

    def decode(self, latent: Tensor) -> Tensor:
        field = self.decoder(self.expand(latent))
        return torch.cat([field[..., :1], field[..., 1:].tanh()], dim=-1)


class NaiveLocalCritic(nn.Module):
    def __init__(self, ours: LocalCritic, hierarchy: GridHierarchy) -> None:
        super().__init__()
        self.layers = NaiveLayers(ours, hierarchy, hierarchy.depth)

    def forward(self, field: Tensor) -> Tensor:
        return self.layers(field).mean(dim=(1, 2))


class NaiveGlobalCritic(nn.Module):
    def __init__(self, ours: GlobalCritic, hierarchy: GridHierarchy) -> None:
        super().__init__()
        self.layers = NaiveLayers(ours.blocks, hierarchy, hierarchy.depth)
        self.score = nn.Linear(ours.score.in_features, 1, bias=False)
        self.score.load_state_dict(ours.score.state_dict())

    def forward(self, field: Tensor) -> Tensor:
        return self.score(self.layers(field).flatten(1)).squeeze(1)


def _adam(module: nn.Module, rate: float, betas: tuple[float, float]) -> torch.optim.Adam:
    return torch.optim.Adam(module.parameters(), rate, betas=betas, foreach=False, fused=False)


class NaiveLearner:
    """The three kinds of step, with the signatures and the random numbers of `TetganLearner`."""

    def __init__(
        self, ours: TetganLearner, hierarchy: GridHierarchy, vertex_operator: sparse.csr_array
    ) -> None:
        self.options = ours.training
        self.generator = NaiveGenerator(ours.generator, hierarchy)
        self.critics = nn.ModuleDict(
            {
                "local": NaiveLocalCritic(ours.critics["local"], hierarchy),  # type: ignore[arg-type]
                "global": NaiveGlobalCritic(ours.critics["global"], hierarchy),  # type: ignore[arg-type]
            }
        )
        matrix = vertex_operator.tocoo()
        self.vertices = torch.sparse_coo_tensor(
            np.stack([matrix.row, matrix.col]),
            matrix.data.astype(np.float32),
            matrix.shape,
            check_invariants=True,
        ).coalesce()
        self.latent_shape = ours.generator.latent_shape
        options = self.options
        self.optimizer = _adam(self.generator, options.learning_rate, options.betas)
        self.adversarial_optimizer = _adam(self.generator, options.learning_rate, options.adversarial_betas)
        self.critic_optimizer = _adam(self.critics, options.critic_learning_rate, options.betas)

    def autoencoder_step(self, field: Tensor, kl_weight: float, draws: torch.Generator) -> dict[str, float]:
        noise = torch.randn(len(field), *self.latent_shape, generator=draws)
        mean, log_variance = self.generator.posterior(field)
        decoded = self.generator.decode(mean + (0.5 * log_variance).exp() * noise)
        occupancy = functional.binary_cross_entropy_with_logits(
            decoded[..., 0], field[..., 0], pos_weight=torch.tensor(self.options.positive_weight)
        )
        displacement = functional.mse_loss(self._at_vertices(decoded), self._at_vertices(field))
        kl = 0.5 * (mean**2 + log_variance.exp() - 1 - log_variance).mean()
        loss = occupancy + self.options.displacement_weight * displacement + kl_weight * kl
        self._step(self.optimizer, loss)
        return {"occupancy_loss": occupancy.item(), "displacement_loss": displacement.item(), "kl": kl.item()}

    def _at_vertices(self, field: Tensor) -> Tensor:
        return torch.stack([torch.sparse.mm(self.vertices, shape) for shape in field[..., 1:]])

    def critic_step(self, real: Tensor, draws: torch.Generator) -> dict[str, float]:
        fake = self._fake(len(real), draws).detach()
        share = torch.rand(len(real), generator=draws)[:, None, None]
        losses, total = {}, torch.zeros(())
        for name, critic in self.critics.items():
            gap = critic(real).mean() - critic(fake).mean()
            between = (share * real + (1 - share) * fake).requires_grad_()
            (gradient,) = torch.autograd.grad(critic(between).sum(), between, create_graph=True)
            penalty = ((gradient.flatten(1).norm(dim=1) - 1) ** 2).mean()
            total = total - gap + self.options.gradient_penalty * penalty
            losses[f"{name}_gap"], losses[f"{name}_penalty"] = gap.item(), penalty.item()
        self._step(self.critic_optimizer, total)
        return losses

    def adversarial_step(self, count: int, draws: torch.Generator) -> dict[str, float]:
        fake, total = self._fake(count, draws), torch.zeros(())
        for name, critic in self.critics.items():
            total = total - getattr(self.options, f"{name}_weight") * critic(fake).mean()
        self._step(self.adversarial_optimizer, total)
        return {"adversarial_loss": total.item()}

    def _fake(self, count: int, draws: torch.Generator) -> Tensor:
        decoded = self.generator.decode(torch.randn(count, *self.latent_shape, generator=draws))
        return torch.cat([decoded[..., :1].sigmoid(), decoded[..., 1:]], dim=-1)

    def _step(self, optimizer: torch.optim.Optimizer, loss: Tensor) -> None:
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
