"""Tet meshes in USD, by Pixar's own library."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from tetgan.errors import UserError
from tetgan.geometry.adjacency import boundary_faces
from tetgan.solids.export import write_tets
from tetgan.solids.reading import read_solid, read_tets
from tetgan.solids.solid import SolidMesh
from tetgan.solids.units import UNITS
from tetgan.solids.usd import SUFFIXES

VERTICES = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
PAIR = SolidMesh(VERTICES, TETS, boundary_faces(TETS))


@pytest.fixture
def pxr():
    pytest.importorskip("pxr.UsdGeom", reason="usd-core comes with the extra 'usd'")
    import pxr

    return pxr


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_pixars_library_finds_the_same_mesh_and_boundary(tmp_path, pxr, suffix):
    write_tets(tmp_path / f"a{suffix}", PAIR, system=UNITS["mm"])
    stage = pxr.Usd.Stage.Open(str(tmp_path / f"a{suffix}"))
    assert pxr.UsdGeom.GetStageMetersPerUnit(stage) == 1e-3
    assert pxr.UsdGeom.GetStageUpAxis(stage) == "Y"
    mesh = pxr.UsdGeom.TetMesh(stage.GetDefaultPrim())
    assert np.array_equal(mesh.GetPointsAttr().Get(), VERTICES)
    assert np.array_equal(mesh.GetTetVertexIndicesAttr().Get(), TETS)
    assert np.array_equal(mesh.GetExtentAttr().Get(), [[0, 0, 0], [1, 1, 1]])
    # Its own surface, by the orientation that the file names: the same faces, turning the same way.
    own = np.array(pxr.UsdGeom.TetMesh.ComputeSurfaceFaces(mesh))
    ours = np.array(mesh.GetSurfaceFaceVertexIndicesAttr().Get())
    assert turned(own) == turned(ours) == turned(PAIR.faces)
    assert list(pxr.UsdGeom.TetMesh.FindInvertedElements(mesh)) == []


def turned(faces):
    """Faces with the least vertex first: the same for the same way round."""
    return {tuple(np.roll(face, -int(np.argmin(face))).tolist()) for face in np.asarray(faces)}


def test_pixars_library_sees_an_inverted_tet(tmp_path, pxr):
    tets = TETS.copy()
    tets[1] = tets[1, [1, 0, 2, 3]]
    write_tets(tmp_path / "a.usda", replace(PAIR, tets=tets))
    stage = pxr.Usd.Stage.Open(str(tmp_path / "a.usda"))
    mesh = pxr.UsdGeom.TetMesh(stage.GetDefaultPrim())
    assert list(pxr.UsdGeom.TetMesh.FindInvertedElements(mesh)) == [1]
    assert (read_solid(tmp_path / "a.usda").volumes < 0).tolist() == [False, True]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_written_is_read(tmp_path, pxr, suffix):
    write_tets(tmp_path / f"a{suffix}", PAIR)
    vertices, tets = read_tets(tmp_path / f"a{suffix}")
    assert np.array_equal(vertices, VERTICES) and np.array_equal(tets, TETS)
    first = (tmp_path / f"a{suffix}").read_bytes()
    write_tets(tmp_path / f"a{suffix}", PAIR)
    assert (tmp_path / f"a{suffix}").read_bytes() == first


@pytest.mark.parametrize(("hand", "mirror"), [("rightHanded", 1), ("leftHanded", 1), ("rightHanded", -1)])
def test_meshes_are_read_at_their_places_and_positive(tmp_path, pxr, hand, mirror):
    """Two meshes, moved, and both left-handed or mirrored: what is not inverted there is not here."""
    stage = pxr.Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    tets = TETS if hand == "rightHanded" else TETS[:, [1, 0, 2, 3]]
    for number in range(2):
        mesh = pxr.UsdGeom.TetMesh.Define(stage, f"/part{number}")
        mesh.CreateOrientationAttr(hand)
        mesh.CreatePointsAttr(pxr.Vt.Vec3fArray.FromNumpy(VERTICES.astype(np.float32)))
        mesh.CreateTetVertexIndicesAttr(pxr.Vt.Vec4iArray.FromNumpy(tets.astype(np.int32)))
        mesh.AddTranslateOp().Set((10 * number, 0, 0))
        mesh.AddScaleOp().Set((mirror, 2, 2))
    stage.Save()
    found = read_solid(tmp_path / "a.usda")
    assert len(found.tets) == 4 and found.volumes.sum() == pytest.approx(2 * 4 * PAIR.volumes.sum())
    assert (found.volumes > 0).all()
    assert found.vertices[5:, 0].max() - 10 == pytest.approx(max(0, mirror))


def test_a_file_without_tets_and_one_that_is_damaged(tmp_path, pxr):
    pxr.Usd.Stage.CreateNew(str(tmp_path / "empty.usda")).Save()
    (tmp_path / "bad.usda").write_text("nothing")
    with pytest.raises(UserError, match=r"empty\.usda: no UsdGeom\.TetMesh in it"):
        read_tets(tmp_path / "empty.usda")
    with pytest.raises(UserError, match=r"bad\.usda: cannot be read as USD"):
        read_tets(tmp_path / "bad.usda")


def test_without_usd_core_the_remedy_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr", None)
    for name in [name for name in sys.modules if name.startswith("pxr.")]:
        monkeypatch.delitem(sys.modules, name)
    told = rf"^{tmp_path}/a\.usda: USD needs usd-core: pip install 'tetgan\[usd\]'"
    with pytest.raises(UserError, match=told):
        write_tets(tmp_path / "a.usda", PAIR)
    assert list(tmp_path.iterdir()) == []
