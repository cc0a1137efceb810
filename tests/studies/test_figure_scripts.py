"""The scripts that draw the figures, run as Snakemake runs them, on a model of boxes."""

import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from tetgan.meshing.options import MeshingOptions
from tetgan.models.samples import sample_model
from tetgan.studies.latent.arithmetic import add_parts
from tetgan.studies.latent.interpolation import interpolate_shapes
from tetgan.studies.latent.nearest import find_nearest_shapes
from tetgan.studies.options import LatentOptions, NearestOptions

SCRIPTS = Path(__file__).parent.parent.parent / "workflow" / "scripts"
LATENT = LatentOptions(pairs=1, steps=3, triples=1, points=300)


@pytest.fixture(scope="module")
def made(project, model, tmp_path_factory) -> Path:
    """Samples, an interpolation, a sum, nearest shapes and a log."""
    folder = tmp_path_factory.mktemp("made")
    index, meshing = project / "index.json", MeshingOptions()
    sample_model(model, index, folder / "samples", count=4, options=meshing, seed=0)
    interpolate_shapes(model, index, folder / "between", options=LATENT, meshing=meshing)
    add_parts(model, index, folder / "sums", options=LATENT, meshing=meshing)
    nearest = NearestOptions(points=300)
    for name, samples in (("model", folder / "samples"), ("real", None)):
        out = folder / f"{name}.csv"
        find_nearest_shapes(
            [project / "meshes.zip"], project / "catalogue.csv", out, samples=samples, options=nearest
        )
    log = {"seconds": [60, 120], "occupancy_loss": [1.0, 0.5], "validation_iou": [0.2, 0.4]}
    pd.DataFrame(log).to_csv(folder / "log.csv", index=False)
    return folder


@pytest.fixture
def draw(made, project, tmp_path, monkeypatch):
    """A figure by the name of its script: the picture and the table beside it."""

    def run(name: str, **inputs) -> tuple[np.ndarray, pd.DataFrame]:
        for stream in ("stdout", "stderr"):
            monkeypatch.setattr(sys, stream, getattr(sys, stream))  # gives back what the script takes
        out = tmp_path / f"{name}.png"
        job = SimpleNamespace(
            input=SimpleNamespace(meshes=[str(project / "meshes.zip")], **inputs),
            params=SimpleNamespace(figure=name, names=["a-model"], columns=4, seeds=[0]),
            output=SimpleNamespace(picture=str(out)),
            log=[str(tmp_path / "log")],
        )
        runpy.run_path(str(SCRIPTS / "draw.py"), init_globals={"snakemake": job})
        return np.asarray(Image.open(out)), pd.read_csv(out.with_suffix(".csv"), dtype={"id": str})

    return run


def with_a_shape(cells: list[np.ndarray]) -> list[bool]:
    """Which cells show more than a word."""
    return [bool((cell < 235).any(axis=2).mean() > 0.04) for cell in cells]


def test_samples(draw, cells, made):
    picture, table = draw("samples", samples=[str(made / "samples")])
    assert with_a_shape(cells) == 16 * [True]
    height, width, _ = cells[0].shape
    assert height == 300 and picture.shape[0] == 4 * 300 and picture.shape[1] > 4 * width
    assert table.groupby("set").size().to_dict() == {"generated": 4, "reconstructed": 4, "validation": 4}
    assert (table["faces"] > 0).all()


def test_comparison(draw, cells, made):
    _, table = draw("comparison", samples=[str(made / "samples")])
    assert with_a_shape(cells) == 8 * [True]
    assert table["model"].tolist() == 4 * ["real"] + 4 * ["a-model"] and (table["faces"] > 0).all()


def test_interpolation(draw, cells, made):
    _, table = draw("interpolation", folders=[str(made / "between")])
    assert with_a_shape(cells) == 5 * [True] + [False, True, True, True, False]
    assert table["t"].tolist() == [0, 0.5, 1]


def test_arithmetic(draw, cells, made):
    _, table = draw("arithmetic", folders=[str(made / "sums")])
    assert with_a_shape(cells) == 4 * [True]
    assert table["model"].tolist() == ["a-model"]
    # The back is added in purple on A and in green on D; nothing of B is.
    a, b, _, d = (cell.reshape(-1, 3).astype(int) for cell in cells)
    assert ((a[:, 2] - a[:, 1]) > 60).mean() > 0.01 > ((b[:, 2] - b[:, 1]) > 60).mean()
    assert ((d[:, 1] - d[:, 0]) > 60).mean() > 0.01


def test_solids(draw, cells, made):
    _, table = draw("solids", samples=[str(made / "samples")])
    shown = np.array(with_a_shape(cells)).reshape(3, 6)
    assert shown[:, :-1].all()
    assert len(table) == 3 and (table["cavities"] == 0).all()


def test_nearest(draw, cells, made):
    tables = {"tables": [str(made / "model.csv")], "real": str(made / "real.csv")}
    _, table = draw("nearest", samples=[str(made / "samples")], **tables)
    assert with_a_shape(cells) == 8 * [True]
    assert table.groupby("model").size().to_dict() == {"a-model": 4, "real": 5}


def test_training(draw, made):
    picture, table = draw("training", weights=[str(made / "weights.safetensors")])
    assert picture.shape[1] == 1440 and (picture < 200).any()
    assert table["validation_iou"].tolist() == [0.2, 0.4]


def test_training_without_a_log(draw, made, tmp_path):
    _, table = draw("training", weights=[str(tmp_path / "weights.safetensors")])
    assert table.empty
