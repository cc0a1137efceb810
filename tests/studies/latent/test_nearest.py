"""The table of nearest training shapes: invariants."""

import numpy as np
import pandas as pd
import pytest
import trimesh

from tetgan.errors import UserError
from tetgan.studies.latent.nearest import find_nearest_shapes
from tetgan.studies.options import NearestOptions

OPTIONS = NearestOptions(points=3000)


def stage(project, out, samples, options=OPTIONS) -> pd.DataFrame:
    find_nearest_shapes(
        [project / "meshes.zip"], project / "catalogue.csv", out, samples=samples, options=options
    )
    return pd.read_csv(out, dtype={"id": str})


def test_a_training_mesh_is_nearest_to_itself(project, tmp_path):
    from tetgan.shapes.archive import read_meshes

    (tmp_path / "samples").mkdir()
    training = {i: mesh for i, *mesh in read_meshes(project / "meshes.zip") if i.startswith("train")}
    for name, (vertices, faces) in training.items():
        trimesh.Trimesh(vertices, faces, process=False).export(tmp_path / "samples" / f"{name}.ply")
    table = stage(project, tmp_path / "out.csv", tmp_path / "samples")
    assert table["nearest"].tolist() == table["id"].tolist() == sorted(training)
    # What is left is the noise of sampling: two draws of 3,000 points on surfaces of area below 4 lie about
    # sqrt(4 / (pi * 3000)) / 2 = 0.01 apart, 2 * 0.01^2 both ways.
    assert table["chamfer"].between(1e-5, 1e-3).all()


def test_without_samples_the_validation_shapes_are_looked_up(project, tmp_path):
    table = stage(project, tmp_path / "out.csv", None)
    assert set(table["id"]) == {"wide-back", "wide", "middle", "narrow", "pole"}
    assert table["nearest"].str.startswith("train").all()
    assert table.set_index("id").loc["wide-back", "nearest"] == "train-6"
    again = stage(project, tmp_path / "again.csv", None)
    assert table.equals(again)
    assert len(stage(project, tmp_path / "two.csv", None, NearestOptions(points=200, samples=2))) == 2


def test_the_samples_of_a_model_are_found_in_its_folder(project, tmp_path):
    folder = tmp_path / "none" / "generated"
    folder.mkdir(parents=True)
    trimesh.creation.box().export(folder / "0001.ply")
    trimesh.Trimesh(np.zeros((3, 3)), [[0, 1, 2]], process=False).export(folder / "0000.ply")
    table = stage(project, tmp_path / "out.csv", tmp_path)
    assert table["id"].tolist() == ["0000", "0001"]
    assert table["nearest"].isna().tolist() == table["chamfer"].isna().tolist() == [True, False]


def test_a_folder_without_meshes_is_named(project, tmp_path):
    with pytest.raises(UserError, match="no meshes"):
        stage(project, tmp_path / "out.csv", tmp_path)
