"""Paths and sums in the latent space of a model of fields."""

from collections.abc import Iterator, Sequence
from typing import Literal

import torch
from jaxtyping import Float
from torch import Tensor

from tetgan.errors import UserError
from tetgan.fields.field import Field, VertexField
from tetgan.fields.store import FieldStore
from tetgan.models.generator import FieldGenerator
from tetgan.models.sampling import decode_fields, encode_shapes

LatentPath = Literal["linear", "spherical"]

_PARALLEL = 1e-6  # sine of the angle below which two latents count as parallel


def interpolate(
    first: Float[Tensor, "*latent"], second: Float[Tensor, "*latent"], steps: int, path: LatentPath
) -> Float[Tensor, "S *latent"]:
    """Latents at even steps from one to the other, both ends included and exact.

    `spherical` (Shoemake 1985) turns about the origin, and the length goes along evenly; it suits latents
    whose prior is N(0, I). Parallel latents, and one of no length, are
    joined by the straight line.

    Raises:
        ValueError: fewer than two steps.
    """
    if steps < 2:
        raise ValueError(f"{steps} steps do not reach from one end to the other")
    weights = torch.linspace(0, 1, steps, dtype=torch.float64)
    towards = torch.stack([1 - weights, weights])
    if path == "spherical":
        towards = _spherical(first, second, towards)
    ends = torch.stack([first, second]).double()
    return torch.tensordot(towards, ends, dims=([0], [0])).to(first.dtype)


def _spherical(
    first: Float[Tensor, "*latent"], second: Float[Tensor, "*latent"], linear: Float[Tensor, "2 S"]
) -> Float[Tensor, "2 S"]:
    """Weights of both ends for a turn at even angles."""
    one, other = (latent.flatten().double() for latent in (first, second))
    lengths = one.norm() * other.norm()
    angle = (one @ other / lengths).clamp(-1, 1).acos()
    if lengths == 0 or angle.sin() < _PARALLEL:
        return linear
    return (linear * angle).sin() / angle.sin()


def add_difference(
    a: Float[Tensor, "*latent"], b: Float[Tensor, "*latent"], c: Float[Tensor, "*latent"]
) -> Float[Tensor, "*latent"]:
    """A - B + C: what A has and B has not, put onto C. Exactly C where A and B are equal."""
    return (a - b) + c


class LatentSpace:
    """A trained model between fields and latents, by the ids of a store."""

    def __init__(self, generator: FieldGenerator, store: FieldStore) -> None:
        self.generator, self.store = generator, store

    def encode(self, ids: Sequence[str]) -> Float[Tensor, "N ..."]:
        """The latent of each shape: the posterior mean, where the model gives a distribution.

        Raises:
            UserError: the store has no such shape.
        """
        known = {*self.store.ids("train"), *self.store.ids("validation")}
        for shape_id in ids:
            if shape_id not in known:
                some = ", ".join(sorted(known)[:3])
                raise UserError(f"no shape '{shape_id}' in the index of fields; it has {some}, ...")
        return encode_shapes(self.generator, self.store, ids)

    def decode(self, latents: Float[Tensor, "N ..."]) -> Iterator[Field | VertexField]:
        """Fields, displacement in cube sides."""
        return decode_fields(self.generator, latents, self.store.max_displacement)
