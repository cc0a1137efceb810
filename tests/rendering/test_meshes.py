"""Shapes that figures read from files."""

import meshio
import numpy as np
import pytest
import trimesh

from tetgan.rendering.meshes import (
    cut_open,
    read_originals,
    read_shape,
)
from tetgan.shapes.archive import write_meshes

BOX = trimesh.creation.box()
TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float)


def test_a_surface_keeps_the_order_of_its_faces(tmp_path):
    BOX.export(tmp_path / "a.ply")
    shape = read_shape(tmp_path / "a.ply")
    assert np.array_equal(shape.faces, BOX.faces)
    assert read_shape(tmp_path / "absent.ply") is None


def test_a_solid_and_its_halves(tmp_path):
    meshio.write(tmp_path / "a.vtu", meshio.Mesh(POINTS, [("tetra", TETS)]))
    solid = tmp_path / "a.vtu"
    # Two tets that share a face: together six outer faces, one alone four.
    assert len(cut_open(solid, (1, 1, 1), 1.0).faces) == 6
    assert len(cut_open(solid, (1, 1, 1), 0.4).faces) == 4
    assert cut_open(tmp_path / "absent.vtu", (1, 0, 0)) is None


def test_originals_come_by_id_from_any_archive(tmp_path):
    paths = []
    for name, scale in (("x", 1.0), ("y", 2.0)):
        paths.append(tmp_path / f"{name}.zip")
        write_meshes(paths[-1], [(name, np.array(BOX.vertices) * scale, np.array(BOX.faces))], [])
    found = read_originals(paths, ["y", "absent", "x"])
    assert found[1] is None
    assert [np.ptp(shape.vertices) for shape in found[::2]] == pytest.approx([2.0, 1.0])
