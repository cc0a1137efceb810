"""Interpolation and arithmetic from a model folder to folders of meshes."""

import numpy as np
import pandas as pd
import pytest
import trimesh

from tetgan.errors import UserError
from tetgan.fields.field import vertex_operator
from tetgan.geometry.triangles import TriangleMesh
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.models.files import load_generator
from tetgan.models.sampling import reconstruct_fields
from tetgan.solids.export import write_surface
from tetgan.studies.latent.arithmetic import add_parts, changed_faces
from tetgan.studies.latent.interpolation import interpolate_shapes
from tetgan.studies.options import LatentOptions

OPTIONS = LatentOptions(pairs=1, steps=3, triples=1, points=500)


def run(stage, project, model, folder, options=OPTIONS, **named):
    stage(model, project / "index.json", folder, options=options, meshing=MeshingOptions(), **named)
    return folder


def test_an_interpolation_begins_and_ends_with_the_reconstructions(project, model, store, tmp_path):
    ids = ["wide", "narrow"]
    folder = run(interpolate_shapes, project, model, tmp_path / "out", pairs=[tuple(ids)])
    generator, grid = load_generator(model, store.hierarchy), store.hierarchy.finest
    operator = vertex_operator(grid)
    for name, (shape_id, field, _) in zip(
        ("00", "02"), reconstruct_fields(generator, store, ids), strict=True
    ):
        solid = build_solid(field, grid, operator, store.mu, MeshingOptions(), smoothing=True)
        write_surface(tmp_path / f"{shape_id}.ply", solid)
        expected = trimesh.load_mesh(tmp_path / f"{shape_id}.ply", process=False)
        got = trimesh.load_mesh(folder / "wide-to-narrow" / f"{name}.ply", process=False)
        assert np.array_equal(got.faces, expected.faces)
        # float32 rounding of the weights of a sum
        np.testing.assert_allclose(got.vertices, expected.vertices, atol=1e-5)
    steps = pd.read_csv(folder / "steps.csv", dtype={"id": str})
    assert steps["t"].tolist() == [0, 0.5, 1] and steps["id"].tolist() == ["00", "01", "02"]
    assert (folder / "wide-to-narrow" / "01.vtu").is_file()


def test_the_distances_of_the_steps_fit_together(project, model, tmp_path):
    folder = run(interpolate_shapes, project, model, tmp_path / "out", pairs=[("wide-back", "narrow")])
    steps = pd.read_csv(folder / "steps.csv")
    assert np.isnan(steps["chamfer_step"][0]) and (steps["chamfer_step"][1:] > 0).all()
    assert steps["chamfer_first"][0] == steps["chamfer_second"][2] == 0
    assert steps["chamfer_first"][2] == pytest.approx(steps["chamfer_second"][0])
    assert steps["chamfer_step"][2] == pytest.approx(steps["chamfer_second"][1])
    assert (steps["volume"] > 0).all()


def test_a_minus_a_plus_c_is_c_to_the_byte(project, model, tmp_path):
    triples = [("wide", "wide", "narrow")]
    folder = run(add_parts, project, model, tmp_path / "out", triples=triples)
    inner = folder / "wide-minus-wide-plus-narrow"
    assert (inner / "D.ply").read_bytes() == (inner / "C.ply").read_bytes()
    with np.load(inner / "changes.npz") as changes:
        assert sorted(changes) == ["A", "B", "C", "D"]
        assert not any(changes[letter].any() for letter in changes)
    row = pd.read_csv(folder / "triples.csv").iloc[0]
    assert row["kept_of_c"] == 1 and np.isnan(row["part_in_d"])


def test_a_back_is_put_onto_the_narrow_stool(project, model, tmp_path):
    folder = run(add_parts, project, model, tmp_path / "out")
    row = pd.read_csv(folder / "triples.csv").iloc[0]
    assert (row["a"], row["b"], row["c"]) == ("wide-back", "wide", "narrow")
    # The model is linear and exact: D is C with the whole back of A, wide as that is.
    assert row["part_in_c"] == 0 and row["part_in_d"] > 0.95 and row["kept_of_c"] > 0.9
    inner = folder / row["triple"]
    surface = trimesh.load_mesh(inner / "D.ply", process=False)
    with np.load(inner / "changes.npz") as changes:
        coloured = surface.triangles_center[changes["D"]]
        assert len(changes["D"]) == len(surface.faces)
    assert len(coloured) and (coloured[:, 1] > 0.5).mean() > 0.9


def test_the_same_seed_gives_the_same_files(project, model, tmp_path):
    one, other = (run(interpolate_shapes, project, model, tmp_path / name) for name in "ab")
    for path in sorted(one.rglob("*")):
        if path.is_file():
            assert path.read_bytes() == (other / path.relative_to(one)).read_bytes()


def test_a_shape_that_is_not_there_is_named(project, model, tmp_path):
    with pytest.raises(UserError, match="no shape 'sofa'"):
        run(interpolate_shapes, project, model, tmp_path / "out", pairs=[("wide", "sofa")])


def test_faces_beyond_the_threshold_have_changed():
    # The unit square as two triangles, and a copy of one of them 0.1 above: their centres are 0.1 away.
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    square = TriangleMesh(vertices, np.array([[0, 1, 2], [0, 2, 3]]))
    raised = TriangleMesh(vertices + np.array([0, 0, 0.1]), np.array([[0, 1, 2]]))
    assert changed_faces(raised, square, 0.09).tolist() == [True]
    assert changed_faces(raised, square, 0.11).tolist() == [False]
    # The centre (1/3, 2/3) of the other triangle is 1/(3 sqrt 2) = 0.24 from the diagonal, sideways.
    assert changed_faces(square, raised, 0.2).tolist() == [False, True]
    assert changed_faces(square, None, 0.2).tolist() == [True, True]
