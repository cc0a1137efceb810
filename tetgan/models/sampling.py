"""Fields out of a trained model: new ones, and reconstructions of known ones."""

from collections.abc import Iterator, Sequence

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from tetgan.fields.field import Field, VertexField
from tetgan.fields.store import FieldStore
from tetgan.models.baselines.representation import RepresentationGenerator
from tetgan.models.generator import FieldGenerator
from tetgan.models.measures import occupancy_iou
from tetgan.nn.device import pick_device

BATCH = 16


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

    A `representation` has no prior: training shapes come in seeded order, again from the start if `count`
    is larger than their number.
    """
    if isinstance(generator, RepresentationGenerator):
        ids = np.random.default_rng(seed).permutation(store.ids("train"))
        yield from (store.read(str(ids[number % len(ids)])) for number in range(count))
        return
    draws = torch.Generator().manual_seed(seed)
    latents = torch.cat([generator.sample_latent(1, draws) for _ in range(count)])
    for batch in latents.split(batch_size):
        decoded = _decode(generator, batch, pick_device(device))
        yield from map(generator.meshed, _to_fields(decoded, store.max_displacement))


def reconstruct_fields(
    generator: FieldGenerator,
    store: FieldStore,
    ids: Sequence[str],
    *,
    batch_size: int = BATCH,
    device: str = "auto",
) -> Iterator[tuple[str, Field | VertexField, float]]:
    """Each shape encoded, decoded from the posterior mean, and its occupancy IoU with the original."""
    if isinstance(generator, RepresentationGenerator):
        yield from ((shape_id, store.read(shape_id), 1.0) for shape_id in ids)
        return
    where = pick_device(device)
    for start in range(0, len(ids), batch_size):
        chunk = list(ids[start : start + batch_size])
        original = store.tensor(chunk)
        with torch.inference_mode():
            latents = generator.to(where).encode(torch.from_numpy(original).to(where))
        fields = _to_fields(_decode(generator, latents, where), store.max_displacement)
        for shape_id, field, true in zip(chunk, fields, original[..., 0] > 0.5, strict=True):
            yield shape_id, generator.meshed(field), float(occupancy_iou(field.occupancy, true))


def _decode(generator: FieldGenerator, latents: Tensor, device: torch.device) -> Float[Tensor, "B T 4"]:
    with torch.inference_mode():
        return generator.to(device).decode(latents.to(device)).cpu()


def _to_fields(decoded: Float[Tensor, "B T 4"], max_displacement: float) -> Iterator[Field]:
    """Occupied where the logit is positive; displacement back in cube sides."""
    for shape in decoded.numpy():
        displacement = shape[:, 1:] * np.float32(max_displacement)
        yield Field(shape[:, 0] > 0, displacement.astype(np.float32))
