"""Samples point clouds of the raw surfaces of a category, for the classifier and for FID."""

import logging
from pathlib import Path

import numpy as np
from jaxtyping import Float
from rich.console import Console
from rich.progress import track

from tetgan.errors import UserError
from tetgan.files import whole_file
from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import clean_mesh
from tetgan.shapes.entries import assign_splits
from tetgan.shapes.normalise import normalise
from tetgan.shapes.options import SourceOptions, SplitOptions
from tetgan.shapes.sampling import sample_exterior
from tetgan.shapes.sources import list_shapes, load_shape

_log = logging.getLogger(__name__)


def sample_clouds(
    category: str,
    source: SourceOptions,
    split: SplitOptions,
    *,
    points: int,
    train: int,
    holdout: int,
    margin: float,
    seed: int,
    out: Path,
) -> None:
    """Write `points` exterior points of each of up to `train` training and `holdout` held-out surfaces.

    Held out are the source's own hold-out shapes where it has any, else the validation split. A mesh that
    cannot be used is skipped, with the reason in the log; the next one takes its place.

    Raises:
        UserError: no usable mesh on either side.
    """
    entries = list_shapes(source, category)
    splits = assign_splits(entries, split)
    kept_back = "holdout" if "holdout" in splits.values() else "validation"
    arrays: dict[str, np.ndarray] = {}
    for name, wanted, count in (("train", "train", train), ("holdout", kept_back, holdout)):
        chosen = [entry for entry in entries if splits[entry.id] == wanted]
        order = np.random.default_rng([seed, len(arrays)]).permutation(len(chosen))
        clouds: dict[str, np.ndarray] = {}
        for position in track(order, f"clouds {category} {name}", console=Console(stderr=True)):
            if len(clouds) == count:
                break
            entry = chosen[position]
            try:
                clouds[entry.id] = _sample_shape(
                    load_shape(source, category, entry),
                    points=points,
                    margin=margin,
                    # By name, not by place: adding shapes must not change the clouds of the others.
                    seed=[seed, *entry.id.encode()],
                )
            except Exception as error:  # untrusted files; one of them must not stop the category
                _log.warning("%s skipped: %s", entry.id, error)
        if not clouds and count:
            raise UserError(f"sources.{category}: no mesh of the {wanted} split can be sampled; see the log")
        ids = sorted(clouds)
        arrays[name] = (
            np.stack([clouds[shape_id] for shape_id in ids]) if ids else np.zeros((0, points, 3), "f4")
        )
        arrays[f"{name}_ids"] = np.array(ids, dtype=np.str_)
    with whole_file(out) as partial, partial.open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **arrays)


def _sample_shape(
    soup: TriangleMesh, *, points: int, margin: float, seed: list[int]
) -> Float[np.ndarray, "P 3"]:
    soup = clean_mesh(soup)
    drawn, _ = sample_exterior(normalise(soup.vertices, margin), soup.faces, points, seed)
    return drawn.astype(np.float32)
