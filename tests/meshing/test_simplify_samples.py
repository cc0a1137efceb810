"""Fewer faces, the same shape; and what cannot be simplified is listed."""

import json

import numpy as np
import pandas as pd
import pytest
import trimesh

from tetgan.errors import UserError
from tetgan.geometry.triangles import TriangleMesh
from tetgan.meshing.marching import voxel_surface
from tetgan.meshing.simplify import simplify_samples
from tetgan.shapes.isolation import SimplifyWorker
from tetgan.shapes.options import SimplifyOptions
from tetgan.solids.export import write_surface
from tetgan.solids.record import surface_record


def ball(subdivisions):
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=0.4)
    return TriangleMesh(np.array(mesh.vertices) + 0.5, np.array(mesh.faces, dtype=np.int64))


@pytest.fixture(scope="module")
def simplified(tmp_path_factory):
    """Samples of a fine ball, a coarse one, nothing, and a file that is no mesh; and what became of them."""
    samples, out = tmp_path_factory.mktemp("samples"), tmp_path_factory.mktemp("simplified")
    rows = [("generated", "0000"), ("generated", "0001"), ("generated", "0002"), ("reconstructed", "chair")]
    (samples / "none").mkdir()
    pd.DataFrame(rows, columns=["set", "id"]).to_csv(samples / "none" / "certificate.csv", index=False)
    write_surface(samples / "none/generated/0000.ply", ball(4))
    write_surface(samples / "none/generated/0001.ply", ball(1))
    (samples / "none/reconstructed").mkdir()
    (samples / "none/reconstructed/chair.ply").write_text("ply\nthis is no mesh\n")
    (samples / "about.json").write_text(json.dumps({"train_minutes": 3}))
    simplify_samples(samples, out, SimplifyOptions(faces=500))
    return out


@pytest.fixture(scope="module")
def certificate(simplified):
    table = pd.read_csv(simplified / "none/certificate.csv", dtype={"id": str}, keep_default_na=False)
    return table.set_index("id")


def test_a_ball_keeps_its_shape_and_stays_closed(simplified, certificate):
    row = certificate.loc["0000"]
    assert 400 < row["faces"] <= 500
    assert row["manifold_edges"] == 1
    mesh = trimesh.load_mesh(simplified / "none/generated/0000.ply")
    assert mesh.is_watertight
    # 500 faces of edge 0.1 lie up to 0.1²/8r below the ball.
    assert np.abs(np.linalg.norm(mesh.vertices - 0.5, axis=1) - 0.4).max() < 0.005
    assert row["volume"] == pytest.approx(4 / 3 * np.pi * 0.4**3, rel=0.03)


def test_few_enough_faces_stay_as_they_are(simplified):
    mesh = trimesh.load_mesh(simplified / "none/generated/0001.ply", process=False)
    np.testing.assert_allclose(mesh.vertices, ball(1).vertices, atol=1e-7)
    np.testing.assert_array_equal(mesh.faces, ball(1).faces)


def test_what_is_missing_or_broken_is_listed(simplified, certificate):
    assert certificate.loc["0002", "reason"] == "no surface"
    assert certificate.loc["chair", "reason"] != ""
    for shape_id in ("0002", "chair"):
        assert certificate.loc[shape_id, "faces"] == 0
    assert not (simplified / "none/reconstructed/chair.ply").exists()
    assert json.loads((simplified / "about.json").read_text()) == {"train_minutes": 3}


def test_the_same_mesh_gives_the_same_faces():
    with SimplifyWorker(SimplifyOptions(faces=200)) as worker:
        one, other = worker.simplify(ball(3)), worker.simplify(ball(3))
    np.testing.assert_array_equal(one.vertices, other.vertices)
    np.testing.assert_array_equal(one.faces, other.faces)
    assert surface_record(one)["manifold_edges"] == 1


def test_flat_walls_stay_closed():
    wall = voxel_surface(np.full((16, 16, 16), -0.1, dtype=np.float32))
    with SimplifyWorker(SimplifyOptions(faces=300)) as worker:
        simplified = worker.simplify(wall)
    assert len(simplified.faces) <= 300
    assert surface_record(simplified)["manifold_edges"] == 1
    assert surface_record(simplified)["volume"] == pytest.approx(surface_record(wall)["volume"], rel=1e-3)


def test_no_samples_is_one_line(tmp_path):
    with pytest.raises(UserError, match=r"^[^\n]*no samples[^\n]*$"):
        simplify_samples(tmp_path, tmp_path / "out", SimplifyOptions())
