"""Surfaces from a trained implicit model: samples and reconstructions."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float
from torch import Tensor

from tetgan.fields.samplings import PointStore, VoxelStore
from tetgan.geometry.triangles import TriangleMesh
from tetgan.meshing.marching import mise, voxel_surface
from tetgan.models.generator import ImplicitGenerator, SurfaceModel, VoxelGenerator
from tetgan.models.iou import occupancy_iou
from tetgan.models.sampling import draw_latents
from tetgan.nn.device import pick_device

ENCODED = 2048
"""Points that an encoder sees, as many as in training; a store has them in random order."""

CHUNK = 2**16  # points evaluated at once


class Extraction(NamedTuple):
    """The grid on which a function is searched for its surface; see `mise`."""

    start: int
    steps: int
    box: float


def extraction_of(model: SurfaceModel, store: PointStore | VoxelStore) -> Extraction | None:
    """Options by which a model's surfaces are extracted; None for models that give voxels."""
    if not isinstance(model, ImplicitGenerator):
        return None
    return Extraction(model.cells, model.halvings, getattr(store, "box", 1.0))


def generate_surfaces(
    model: SurfaceModel, extraction: Extraction | None, count: int, seed: int, *, device: str = "auto"
) -> Iterator[TriangleMesh]:
    """Decoded draws of the prior, without faces where a draw came out empty."""
    for latents in draw_latents(model, count, seed, device=device):
        yield from (decode_surface(model, latent, extraction) for latent in latents.split(1))


def reconstruct_surfaces(
    model: SurfaceModel,
    extraction: Extraction | None,
    store: PointStore | VoxelStore,
    ids: Sequence[str],
    *,
    device: str = "auto",
) -> Iterator[tuple[str, TriangleMesh, float]]:
    """Each shape encoded, decoded from the posterior mean, and its occupancy IoU where it was sampled.

    Nothing for a model without an encoder.
    """
    if not model.has_encoder:
        return
    where = pick_device(device)
    model = model.to(where)
    for shape_id in ids:
        data = _encoder_input(store, shape_id).to(where)
        with torch.inference_mode():
            latent = model.encode(data)
        predicted, true = _occupancies(model, latent, store, shape_id)
        yield shape_id, decode_surface(model, latent, extraction), float(occupancy_iou(predicted, true))


def decode_surface(
    model: SurfaceModel, latent: Float[Tensor, "1 ..."], extraction: Extraction | None
) -> TriangleMesh:
    """The surface of one latent, which lies on the model's device.

    Args:
        extraction: where to look for it; for models that give voxels nothing.
    """
    if isinstance(model, VoxelGenerator):
        return voxel_surface(_voxels(model, latent))
    assert isinstance(model, ImplicitGenerator) and extraction is not None
    start, steps, box = extraction
    return mise(lambda points: _values(model, latent, points), start, steps, model.level, box=box)


def _encoder_input(store: PointStore | VoxelStore, shape_id: str) -> Float[Tensor, "1 ..."]:
    if isinstance(store, VoxelStore):
        return torch.from_numpy(store.read(shape_id))[None]
    points, occupancy = store.read(shape_id)
    seen = np.column_stack([points, occupancy]).astype(np.float32)[:ENCODED]
    return torch.from_numpy(seen)[None]


def _occupancies(
    model: SurfaceModel, latent: Float[Tensor, "1 ..."], store: PointStore | VoxelStore, shape_id: str
) -> tuple[Bool[np.ndarray, "N"], Bool[np.ndarray, "N"]]:
    """Which of a shape's points or voxels the model takes to be inside, and which are."""
    if isinstance(store, VoxelStore):
        assert isinstance(model, VoxelGenerator)
        return _voxels(model, latent).ravel() < 0, store.read(shape_id).ravel() < 0
    assert isinstance(model, ImplicitGenerator)
    points, occupancy = store.read(shape_id)
    return _values(model, latent, points) > model.level, occupancy


@torch.inference_mode()
def _voxels(model: VoxelGenerator, latent: Float[Tensor, "1 ..."]) -> Float[np.ndarray, "R R R"]:
    return model.voxels(latent)[0].cpu().numpy()


@torch.inference_mode()
def _values(
    model: ImplicitGenerator, latent: Float[Tensor, "1 ..."], points: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "N"]:
    chunks = torch.from_numpy(points.astype(np.float32)).split(CHUNK)
    values = [model.value(latent, chunk[None].to(latent.device))[0].cpu() for chunk in chunks]
    return torch.cat(values).numpy()
