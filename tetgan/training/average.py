"""Exponential moving average of weights."""

from collections.abc import Iterator
from contextlib import contextmanager

import torch
from torch import Tensor, nn


class WeightAverage:
    """Exponential moving average of a module's weights; without a decay it is the weights themselves.

    Early on the mean runs over few steps, min(decay, (1 + n) / (10 + n)), or it would remember the start.
    """

    def __init__(self, module: nn.Module, decay: float | None) -> None:
        self.module, self.decay, self.steps = module, decay, 0
        self.mean = {name: p.detach().clone() for name, p in module.named_parameters()} if decay else {}

    @torch.no_grad()
    def update(self) -> None:
        """Take in the weights of one more step."""
        if self.decay is None:
            return
        self.steps += 1
        keep = min(self.decay, (1 + self.steps) / (10 + self.steps))
        parameters = [p.detach() for p in self.module.parameters()]
        torch._foreach_lerp_(list(self.mean.values()), parameters, 1 - keep)

    @contextmanager
    def applied(self) -> Iterator[None]:
        """Inside, the module has the averaged weights."""
        parameters = dict(self.module.named_parameters())
        current = {name: parameters[name].detach().clone() for name in self.mean}
        self._put(self.mean)
        try:
            yield
        finally:
            self._put(current)

    @torch.no_grad()
    def _put(self, weights: dict[str, Tensor]) -> None:
        for name, parameter in self.module.named_parameters():
            if name in weights:
                parameter.copy_(weights[name])

    def state_dict(self) -> dict[str, object]:
        return {"steps": self.steps, "mean": self.mean}

    def load_state_dict(self, state: dict[str, object]) -> None:
        self.steps = int(state["steps"])  # type: ignore[call-overload]
        for name, value in state["mean"].items():  # type: ignore[attr-defined]
            self.mean[name].copy_(value)
