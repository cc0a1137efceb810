"""Small clouds and meshes that several tests share."""

from pathlib import Path

import numpy as np
import pytest

CATEGORIES = ("slab", "rod")
SIZES = {"slab": (1.0, 0.1, 1.0), "rod": (0.1, 1.0, 0.1)}


def box_cloud(rng: np.random.Generator, category: str, points: int = 1100) -> np.ndarray:
    """Points in a box of about the category's proportions; its inside serves as well as its surface."""
    size = np.array(SIZES[category]) * rng.uniform(0.7, 1.3, 3)
    return (0.5 + size * (rng.random((points, 3)) - 0.5)).astype(np.float32)


def write_clouds(path: Path, category: str, train: int, holdout: int) -> None:
    """The format of `tetgan.shapes.clouds`."""
    rng = np.random.default_rng(len(category))
    arrays = {
        name: np.stack([box_cloud(rng, category) for _ in range(count)])
        for name, count in (("train", train), ("holdout", holdout))
    }
    ids = {f"{name}_ids": np.array([f"{name}{i}" for i in range(len(a))]) for name, a in arrays.items()}
    np.savez(path, **arrays, **ids)


@pytest.fixture(scope="session")
def clouds(tmp_path_factory) -> list[Path]:
    """A file of clouds for each of two categories."""
    folder = tmp_path_factory.mktemp("clouds")
    for category in CATEGORIES:
        write_clouds(folder / f"{category}.npz", category, 6, 6)
    return [folder / f"{category}.npz" for category in CATEGORIES]


@pytest.fixture(scope="session")
def extractor(clouds, tmp_path_factory) -> Path:
    """An extractor trained for seconds."""
    from tetgan.evaluation.extractor import train_extractor
    from tetgan.evaluation.options import ExtractorOptions

    folder = tmp_path_factory.mktemp("extractor") / "trained"
    options = ExtractorOptions(train=6, holdout=2, epochs=2, batch_size=4, noise_samples=8)
    train_extractor(clouds, CATEGORIES, options, folder)
    return folder
