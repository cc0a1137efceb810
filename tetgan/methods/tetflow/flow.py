"""Rectified flow on codes: a transformer over the coarsest tets (Liu et al. 2023, Peebles & Xie 2023)."""

import math
from itertools import pairwise

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

FREQUENCIES = 32  # at which the time is told, from 1 to 1,000

EXPANSION = 3  # of a layer's hidden width over its channels


class Layer(nn.Module):
    """Attention, then a perceptron; the time scales, shifts and weighs both, by nothing at the start."""

    def __init__(self, channels: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.norm = nn.LayerNorm(channels, elementwise_affine=False)
        self.project, self.join = nn.Linear(channels, 3 * channels), nn.Linear(channels, channels)
        self.perceptron = nn.Sequential(
            nn.Linear(channels, EXPANSION * channels), nn.SiLU(), nn.Linear(EXPANSION * channels, channels)
        )
        self.modulate = nn.Linear(channels, 6 * channels)
        nn.init.zeros_(self.modulate.weight)
        nn.init.zeros_(self.modulate.bias)

    def forward(self, x: Float[Tensor, "B K C"], time: Float[Tensor, "B C"]) -> Float[Tensor, "B K C"]:
        scale, shift, weight, scale_2, shift_2, weight_2 = self.modulate(time)[:, None].chunk(6, dim=-1)
        x = x + weight * self._attend(self.norm(x) * (1 + scale) + shift)
        return x + weight_2 * self.perceptron(self.norm(x) * (1 + scale_2) + shift_2)

    def _attend(self, x: Float[Tensor, "B K C"]) -> Float[Tensor, "B K C"]:
        query, key, value = self.project(x).unflatten(-1, (3, self.heads, -1)).permute(2, 0, 3, 1, 4)
        # In half precision its backward pass takes five times as long on a CPU.
        with torch.autocast(x.device.type, enabled=False):
            found = functional.scaled_dot_product_attention(query.float(), key.float(), value.float())
        return self.join(found.transpose(1, 2).flatten(2))


class CodeFlow(nn.Module):
    """The velocity that carries noise at time 0 to a standardised code at time 1."""

    def __init__(self, tets: int, code: int, channels: int, layers: int, heads: int) -> None:
        super().__init__()
        self.enter = nn.Linear(code, channels)
        self.place = nn.Parameter(0.1 * torch.randn(tets, channels))
        self.layers = nn.ModuleList(Layer(channels, heads) for _ in range(layers))
        self.norm, self.leave = nn.LayerNorm(channels), nn.Linear(channels, code)
        self.time = nn.Sequential(
            nn.Linear(2 * FREQUENCIES, channels), nn.SiLU(), nn.Linear(channels, channels), nn.SiLU()
        )
        nn.init.zeros_(self.leave.weight)
        nn.init.zeros_(self.leave.bias)

    def forward(self, x: Float[Tensor, "B K Z"], time: Float[Tensor, "B"]) -> Float[Tensor, "B K Z"]:
        """Velocity of codes on their way, each at its time."""
        rates = torch.linspace(0, math.log(1000), FREQUENCIES, device=x.device).exp()
        angles = time[:, None] * rates
        told = self.time(torch.cat([angles.sin(), angles.cos()], dim=1))
        x = self.enter(x).float() + self.place
        for layer in self.layers:
            x = layer(x, told)
        return self.leave(self.norm(x)).float()

    def carry(self, noise: Float[Tensor, "B K Z"], steps: int) -> Float[Tensor, "B K Z"]:
        """Codes from noise: equal steps by Heun's method, the last by Euler's."""
        x, times = noise, torch.linspace(0, 1, steps + 1).tolist()
        for number, (now, then) in enumerate(pairwise(times)):
            velocity = self(x, x.new_full((len(x),), now))
            ahead = x + (then - now) * velocity
            if number + 1 < steps:
                velocity = (velocity + self(ahead, x.new_full((len(x),), then))) / 2
                ahead = x + (then - now) * velocity
            x = ahead
        return x


def flow_loss(
    flow: nn.Module,
    code: Float[Tensor, "B K Z"],
    noise: Float[Tensor, "B K Z"],
    time: Float[Tensor, "B"],
) -> Float[Tensor, ""]:
    """Mean squared error of the velocity at a point of the straight way from noise to code."""
    share = time[:, None, None]
    return functional.mse_loss(flow((1 - share) * noise + share * code, time), code - noise)
