"""Fields from a trained model: samples and reconstructions."""

from collections.abc import Iterator, Sequence

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from tetgan.fields.field import Field, VertexField
from tetgan.fields.store import FieldStore
from tetgan.models.generator import FieldGenerator, LatentModel
from tetgan.models.iou import occupancy_iou
from tetgan.nn.device import pick_device

BATCH = 16


def draw_latents(
    model: LatentModel, count: int, seed: int, *, batch_size: int = BATCH, device: str = "auto"
) -> Iterator[Float[Tensor, "_B ..."]]:
    """Draws of the prior in batches, on the device; their random numbers depend on the seed alone."""
    draws, where = torch.Generator().manual_seed(seed), pick_device(device)
    model = model.to(where)
    for start in range(0, count, batch_size):
        noise = [model.draw_noise(draws) for _ in range(start, min(start + batch_size, count))]
        with torch.inference_mode():
            latents = model.from_noise(torch.stack(noise).to(where))
        yield latents


def generate_fields(
    generator: FieldGenerator,
    store: FieldStore,
    count: int,
    seed: int,
    *,
    batch_size: int = BATCH,
    device: str = "auto",
) -> Iterator[Field | VertexField]:
    """Decoded draws of the prior; which ones depends on the seed, not on the batch size.

    A model that only passes fields on has no prior: training shapes come in seeded order, again from the
    start if `count` is larger than their number.
    """
    if generator.is_identity:
        ids = np.random.default_rng(seed).permutation(store.ids("train"))
        yield from (store.read(str(ids[number % len(ids)])) for number in range(count))
        return
    for latents in draw_latents(generator, count, seed, batch_size=batch_size, device=device):
        yield from decode_fields(
            generator, latents, store.max_displacement, batch_size=batch_size, device=device
        )


def reconstruct_fields(
    generator: FieldGenerator,
    store: FieldStore,
    ids: Sequence[str],
    *,
    batch_size: int = BATCH,
    device: str = "auto",
) -> Iterator[tuple[str, Field | VertexField, float]]:
    """Each shape encoded, decoded from the posterior mean, and its occupancy IoU with the original."""
    if generator.is_identity:
        yield from ((shape_id, store.read(shape_id), 1.0) for shape_id in ids)
        return
    for start in range(0, len(ids), batch_size):
        chunk = list(ids[start : start + batch_size])
        latents = encode_shapes(generator, store, chunk, batch_size=batch_size, device=device)
        fields = decode_fields(
            generator, latents, store.max_displacement, batch_size=batch_size, device=device
        )
        for shape_id, field in zip(chunk, fields, strict=True):
            yield shape_id, field, float(occupancy_iou(field.occupancy, store.read(shape_id).occupancy))


def encode_shapes(
    generator: FieldGenerator,
    store: FieldStore,
    ids: Sequence[str],
    *,
    batch_size: int = BATCH,
    device: str = "auto",
) -> Float[Tensor, "N ..."]:
    """The latent of each shape, on the CPU."""
    where, latents = pick_device(device), []
    for start in range(0, len(ids), batch_size):
        original = torch.from_numpy(store.tensor(ids[start : start + batch_size]))
        with torch.inference_mode():
            latents.append(generator.to(where).encode(original.to(where)).cpu())
    return torch.cat(latents)


def decode_fields(
    generator: FieldGenerator,
    latents: Float[Tensor, "N ..."],
    max_displacement: float,
    *,
    batch_size: int = BATCH,
    device: str = "auto",
) -> Iterator[Field | VertexField]:
    """Fields to be meshed for each latent, displacement in cube sides."""
    where = pick_device(device)
    for batch in latents.split(batch_size):
        with torch.inference_mode():
            decoded = generator.to(where).decode(batch.to(where)).cpu()
        yield from map(generator.meshed, _to_fields(decoded, max_displacement))


def _to_fields(decoded: Float[Tensor, "B T 4"], max_displacement: float) -> Iterator[Field]:
    """Occupied where the logit is positive; displacement back in cube sides."""
    for shape in decoded.numpy():
        displacement = shape[:, 1:] * np.float32(max_displacement)
        yield Field(shape[:, 0] > 0, displacement.astype(np.float32))
