"""Surfaces from files, and folders of samples."""

import numpy as np
import pandas as pd
import pytest
import trimesh

from tetgan.errors import UserError
from tetgan.evaluation.surfaces import Topology, draw_sample, measure_topology
from tetgan.solids.folder import SampleFolder
from tetgan.solids.reading import read_surface


def write_certificate(folder, rows):
    pd.DataFrame(rows).to_csv(folder / "certificate.csv", index=False)


TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def test_edges_are_counted_by_their_faces():
    box = np.asarray(trimesh.creation.box().faces)
    # 12 triangles have 18 edges. Without one of them three edges have one face; with it twice, three.
    assert measure_topology(box) == Topology(1, 0, 0, 1)
    assert measure_topology(box[1:]) == pytest.approx((15 / 18, 3 / 18, 0, 0))
    assert measure_topology(np.concatenate([box, box[:1]])) == pytest.approx((15 / 18, 0, 3 / 18, 0))


def test_a_pinched_vertex_is_no_manifold_though_its_edges_are():
    # Two tetrahedra that share vertex 0 and nothing else, and two that share nothing.
    apart = TETRAHEDRON + 4
    assert measure_topology(np.concatenate([TETRAHEDRON, apart])) == Topology(1, 0, 0, 1)
    assert measure_topology(np.concatenate([TETRAHEDRON, np.where(apart == 4, 0, apart)])) == (1, 0, 0, 0)


def test_two_tetrahedra_that_share_an_edge_have_four_faces_there():
    other = np.array([0, 1, 4, 5])[TETRAHEDRON]
    # 6 + 6 edges, one of them common.
    assert measure_topology(np.concatenate([TETRAHEDRON, other])) == pytest.approx((10 / 11, 0, 1 / 11, 0))


def test_vertices_without_faces_play_no_part():
    assert measure_topology(TETRAHEDRON + 7) == Topology(1, 0, 0, 1)


def test_no_faces_have_no_share():
    with pytest.raises(ValueError, match="no faces"):
        measure_topology(trimesh.creation.box().faces[:0])


def test_a_surface_is_read_exactly_as_stored(tmp_path):
    box = trimesh.creation.box()
    box.export(tmp_path / "box.ply")
    surface = read_surface(tmp_path / "box.ply")
    assert surface is not None
    assert surface.faces.tolist() == box.faces.tolist()
    assert surface.vertices == pytest.approx(box.vertices)


def test_missing_empty_and_flat_surfaces_are_none(tmp_path):
    assert read_surface(tmp_path / "missing.ply") is None
    trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], process=False).export(
        tmp_path / "flat.ply"
    )
    assert read_surface(tmp_path / "flat.ply") is None
    empty = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
    empty += "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
    (tmp_path / "empty.ply").write_text(empty)
    assert read_surface(tmp_path / "empty.ply") is None


def test_a_damaged_surface_is_named(tmp_path):
    for name, content in (("text.ply", "garbage"), ("odd.off", "3")):
        (tmp_path / name).write_text(content)
        with pytest.raises(UserError, match=rf"{name}: cannot be read as a mesh \(.*; remove it"):
            read_surface(tmp_path / name)


def test_samples_lie_on_the_surface_with_its_normals(tmp_path):
    box = trimesh.creation.box()
    box.export(tmp_path / "box.ply")
    surface = read_surface(tmp_path / "box.ply")
    assert surface is not None
    sample = draw_sample(surface, 500, seed=3)
    assert abs(sample.points).max(axis=1) == pytest.approx(0.5, abs=1e-12)
    assert (sample.points * sample.normals).sum(1) == pytest.approx(0.5, abs=1e-12)


def test_ids_come_from_the_certificate_or_else_from_the_files(tmp_path):
    (tmp_path / "generated").mkdir()
    trimesh.creation.box().export(tmp_path / "generated" / "007.ply")
    assert SampleFolder(tmp_path).ids("generated") == ["007"]
    write_certificate(tmp_path, [{"set": "generated", "id": "007"}, {"set": "generated", "id": "nan"}])
    folder = SampleFolder(tmp_path)
    assert folder.ids("generated") == ["007", "nan"]
    assert folder.surface("generated", "nan") is None
    assert folder.ids("reconstructed") == []


def test_inverted_share_is_of_each_mesh_with_tets(tmp_path):
    rows = [
        {"set": "generated", "id": "a", "tets": 10, "inverted_tets": 5, "iou": None},
        {"set": "generated", "id": "b", "tets": 0, "inverted_tets": 0, "iou": None},
        {"set": "reconstructed", "id": "c", "tets": 4, "inverted_tets": 1, "iou": 0.5},
    ]
    write_certificate(tmp_path, rows)
    folder = SampleFolder(tmp_path)
    assert folder.inverted_shares("generated").tolist() == [0.5]
    assert folder.inverted_shares("reconstructed").tolist() == [0.25]
    assert folder.certified("reconstructed", "iou").tolist() == [0.5]
    assert folder.certified("generated", "iou").tolist() == []
    assert folder.certified("generated", "no such column").tolist() == []


def test_a_certificate_that_is_none_says_so(tmp_path):
    (tmp_path / "certificate.csv").write_text("")
    with pytest.raises(UserError, match="not a certificate"):
        SampleFolder(tmp_path).ids("generated")
    (tmp_path / "certificate.csv").write_text("mesh,valid\na.vtu,True\n")  # what `tetgan certify` writes
    with pytest.raises(UserError, match="no columns 'set' and 'id'"):
        SampleFolder(tmp_path).ids("generated")
