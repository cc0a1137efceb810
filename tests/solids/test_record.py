"""Rows of the certificate of samples."""

import numpy as np
import pytest

from tetgan.geometry.adjacency import boundary_faces
from tetgan.solids.certificate import certify
from tetgan.solids.record import quality_record
from tetgan.solids.solid import SolidChanges, SolidMesh

CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TET = np.array([[0, 1, 2, 3]])


def test_a_row_is_the_certificate_and_what_made_the_solid():
    changes = SolidChanges(snapped=2, held=1, dropped=(0.25, 0.0625))
    record = quality_record(SolidMesh(CORNER, TET, boundary_faces(TET), changes))
    expected = certify(CORNER, TET).row() | {
        # Straight in from a face at a corner's right angles: its centroid lies 1/3 under the slanted face.
        "thickness": pytest.approx(1 / 3, abs=1e-5),
        "snapped": 2,
        "held": 1,
        "dropped_components": 2,
        "dropped_volume": 0.3125,
        "dropped": "0.25 0.0625",
    }
    assert record == expected


def test_an_empty_mesh_is_all_zeros():
    nothing = np.empty((0, 4), dtype=np.int64)
    record = quality_record(SolidMesh(np.empty((0, 3)), nothing, boundary_faces(nothing)))
    assert record.pop("reasons") == "no tets"
    assert record.pop("dropped") == ""
    assert record.pop("radius_ratios") == " ".join("0" * 10)
    assert set(record.values()) == {0}
