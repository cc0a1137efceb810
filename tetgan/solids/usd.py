"""Tet meshes of USD (`UsdGeom.TetMesh`), through usd-core, which the extra `usd` brings."""

import importlib
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from tetgan.errors import UserError
from tetgan.solids.elements import Elements

SUFFIXES = (".usda", ".usdc", ".usd")

_NAME = "/solid"


def write_usd(path: Path, elements: Elements, metres_per_unit: float) -> None:
    """Write one right-handed tet mesh, y up, with its boundary; coordinates have single precision.

    USD numbers the corners of tets and of faces as we do: of a right-handed tet, faces 123, 032, 013 and 021
    turn counter-clockwise seen from outside.

    Raises:
        UserError: usd-core is not installed.
    """
    pxr = load_pxr(path)
    stage = pxr.Usd.Stage.CreateInMemory()
    pxr.UsdGeom.SetStageUpAxis(stage, pxr.UsdGeom.Tokens.y)
    pxr.UsdGeom.SetStageMetersPerUnit(stage, metres_per_unit)
    mesh = pxr.UsdGeom.TetMesh.Define(stage, _NAME)
    stage.SetDefaultPrim(mesh.GetPrim())
    points = np.ascontiguousarray(elements.nodes, dtype=np.float32)
    mesh.CreateOrientationAttr(pxr.UsdGeom.Tokens.rightHanded)
    mesh.CreatePointsAttr(pxr.Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateExtentAttr(pxr.Vt.Vec3fArray.FromNumpy(np.stack([points.min(axis=0), points.max(axis=0)])))
    mesh.CreateTetVertexIndicesAttr(pxr.Vt.Vec4iArray.FromNumpy(_integers(elements.tets)))
    mesh.CreateSurfaceFaceVertexIndicesAttr(pxr.Vt.Vec3iArray.FromNumpy(_integers(elements.faces[:, :3])))
    stage.GetRootLayer().Export(str(path))


def read_usd(path: Path) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "T 4"]]:
    """Vertices and tets of all tet meshes of a file, each at its place; left-handed ones are turned.

    Raises:
        UserError: usd-core is not installed, the file cannot be read, or holds no tet mesh.
    """
    pxr = load_pxr(path)
    try:
        # A layer of its own: one that is open elsewhere may be older than the file.
        stage = pxr.Usd.Stage.Open(pxr.Sdf.Layer.OpenAsAnonymous(str(path)))
    except pxr.Tf.ErrorException as error:
        told = " ".join(str(error).split())
        raise UserError(f"{path}: cannot be read as USD ({told})") from None
    meshes = [pxr.UsdGeom.TetMesh(prim) for prim in stage.Traverse() if prim.IsA(pxr.UsdGeom.TetMesh)]
    vertices, tets, count = [np.empty((0, 3))], [np.empty((0, 4), dtype=np.int64)], 0
    for mesh in meshes:
        points, corners = _world(mesh, pxr)
        vertices.append(points)
        tets.append(corners + count)
        count += len(points)
    if not count:
        raise UserError(f"{path}: no UsdGeom.TetMesh in it")
    return np.concatenate(vertices), np.concatenate(tets)


def _world(mesh: Any, pxr: Any) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "T 4"]]:
    """Points and tets of a mesh at the earliest time, positive where they are not inverted."""
    time = pxr.Usd.TimeCode.EarliestTime()
    points = np.array(mesh.GetPointsAttr().Get(time) or [], dtype=np.float64).reshape(-1, 3)
    tets = np.array(mesh.GetTetVertexIndicesAttr().Get(time) or [], dtype=np.int64).reshape(-1, 4)
    matrix = np.array(mesh.ComputeLocalToWorldTransform(time))  # of row vectors
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    if mirrored != (mesh.GetOrientationAttr().Get() == pxr.UsdGeom.Tokens.leftHanded):
        tets = tets[:, [0, 1, 3, 2]]
    return points @ matrix[:3, :3] + matrix[3, :3], tets


def _integers(values: Int[np.ndarray, "N K"]) -> Int[np.ndarray, "N K"]:
    return np.ascontiguousarray(values, dtype=np.int32)


def load_pxr(path: str | Path) -> Any:
    """Pixar's package, for a file.

    Raises:
        UserError: usd-core is not installed.
    """
    try:
        for name in ("Sdf", "Tf", "Usd", "UsdGeom", "Vt"):
            importlib.import_module(f"pxr.{name}")
    except ImportError:
        raise UserError(f"{path}: USD needs usd-core: pip install 'tetgan[usd]'") from None
    return importlib.import_module("pxr")
