"""Folders of meshes and the rows of their certificate."""

import json

import meshio
import numpy as np
import trimesh

from tetgan.fields.field import Field, vertex_operator
from tetgan.meshing.build import build_solid
from tetgan.meshing.options import MeshingOptions
from tetgan.meshing.samples import write_solids
from tetgan.solids.record import quality_record


def test_each_field_gets_three_files_and_a_row(tmp_path, grid, operator, make_field):
    fields = {"a": make_field(0), "b": make_field(1, 0.9)}
    items = ((name, field, {"set": "generated", "iou": 0.5}) for name, field in fields.items())
    rows = write_solids(tmp_path / "out", items, grid, 0.02, MeshingOptions(), smoothing=True)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        f"{name}.{suffix}" for name in "ab" for suffix in ("json", "ply", "vtu")
    ]
    for row, (name, field) in zip(rows, fields.items(), strict=True):
        mesh = build_solid(field, grid, operator, 0.02, MeshingOptions(), smoothing=True)
        assert row == {"id": name, "set": "generated", "iou": 0.5, **quality_record(mesh)}
        written = json.loads((tmp_path / "out" / f"{name}.json").read_text())
        assert (written["tets"], written["valid"]) == (row["tets"], row["valid"])
        assert len(trimesh.load(tmp_path / "out" / f"{name}.ply", process=False).faces) == row["faces"]
        assert len(meshio.read(tmp_path / "out" / f"{name}.vtu").cells_dict["tetra"]) == row["tets"]


def test_an_empty_field_has_a_row_and_no_files(tmp_path, grid):
    nothing = Field(np.zeros(len(grid.tets), dtype=bool), np.zeros((len(grid.tets), 3), dtype=np.float32))
    (row,) = write_solids(tmp_path, [("x", nothing, {})], grid, 0.02, MeshingOptions(), smoothing=False)
    assert row == {
        "id": "x",
        **quality_record(
            build_solid(nothing, grid, vertex_operator(grid), 0.02, MeshingOptions(), smoothing=False)
        ),
    }
    assert (row["tets"], row["valid"], row["reasons"]) == (0, False, "no tets")
    assert list(tmp_path.iterdir()) == []
