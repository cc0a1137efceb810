"""Schedules over a run: KL weight, step size, head start, adversarial rounds."""

import math
from typing import Literal

from tetgan.methods.tetgan.options import TetganTraining

EPOCH_SHAPES = 5648  # an epoch of the paper's chairs; the KL schedule counts in these


def kl_weight(shapes: int, options: TetganTraining) -> float:
    """Weight of the KL term after `shapes` shapes: kl_weight · (1 − 0.99 · kl_decay^(shapes / 5,648))."""
    return options.kl_weight * (1 - 0.99 * options.kl_decay ** (shapes / EPOCH_SHAPES))


def rate_factor(progress: float, decay: Literal["constant", "cosine"]) -> float:
    """Factor of a step size at `progress` (0 to 1) through the run."""
    if decay == "constant":
        return 1.0
    return 0.01 + 0.99 * (1 + math.cos(math.pi * progress)) / 2


def bypass_steps(steps: int, options: TetganTraining) -> int:
    """Number of the `steps` that go around the latent head."""
    return round(options.head_start * steps)


def first_adversarial_step(steps: int, options: TetganTraining) -> int:
    """The autoencoder step after which critics begin: not during the bypass; `steps` where they never do."""
    if options.local_weight == options.global_weight == 0:
        return steps
    return max(math.ceil(options.adversarial_start * steps), bypass_steps(steps, options))


def adversarial_step_due(step: int, steps: int, options: TetganTraining) -> bool:
    """Whether an adversarial round follows autoencoder step `step` of `steps`."""
    return step >= first_adversarial_step(steps, options) and step % options.adversarial_every == 0
