"""Errors of the torus converge as theory says, and the resolution to reach an error is read off right."""

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from tetgan.errors import UserError
from tetgan.studies.options import ResolutionOptions
from tetgan.studies.resolution.representations import BINARY, BLOCKY, DEFORMED, DISTANCE, UNDEFORMED
from tetgan.studies.resolution.study import (
    convergence_order,
    measure_curves,
    measure_resolution,
    resolution_to_reach,
    summarise,
    surface_error,
)
from tetgan.studies.resolution.torus import Torus

TINY = {"cells": [1, 2, 3], "deformed_cells": [1, 2], "depth": 1, "voxels": [8, 16, 32], "points": 2000}


def test_a_torus_is_at_distance_zero_and_a_thicker_one_further(torus):
    near = surface_error(torus.mesh(400, 200), torus, 20_000, seed=0)
    assert near.symmetric < 1e-4
    thicker = Torus(torus.major, torus.minor + 0.01, torus.axis)
    far = surface_error(thicker.mesh(400, 200), torus, 20_000, seed=0)
    assert far.to_torus == pytest.approx(0.01, abs=1e-4)
    assert far.from_torus == pytest.approx(0.01, abs=1e-4)
    assert far.symmetric == (far.to_torus + far.from_torus) / 2


def test_orders_of_convergence():
    """Occupancy alone is first order in the size of an element, displacements and distances second."""
    options = ResolutionOptions.parse(
        {
            "cells": [2, 3, 4, 6],
            "deformed_cells": [2, 3, 4, 6],
            "depth": 2,
            "voxels": [32, 64, 96],
            "points": 10_000,
        }
    )
    curves = measure_curves(Torus(**options.torus.model_dump()), options)
    orders = summarise(curves, options.reference_cells).set_index("representation")["order"]
    assert orders[UNDEFORMED] == pytest.approx(1, abs=0.2)
    assert orders[BINARY] == pytest.approx(1, abs=0.2)
    assert orders[BLOCKY] == pytest.approx(1, abs=0.2)
    assert orders[DEFORMED] == pytest.approx(2, abs=0.4)
    assert orders[DISTANCE] == pytest.approx(2, abs=0.2)
    assert (curves["error"] == (curves["to_torus"] + curves["from_torus"]) / 2).all()


def test_the_resolution_to_reach_an_error_is_exact_on_a_power_law():
    sides = np.array([10.0, 20, 40, 80])
    found = resolution_to_reach(sides, 3 / sides**1.5, 3 / 33**1.5)
    assert found.value == pytest.approx(33)
    assert str(found) == "33.0"
    assert convergence_order(sides, 3 / sides**1.5) == pytest.approx(1.5)


def test_beyond_what_was_measured_it_says_so():
    sides, errors = np.array([10.0, 20, 40]), np.array([4.0, 2, 1])
    assert str(resolution_to_reach(sides, errors, 0.5)) == "> 40.0"
    assert str(resolution_to_reach(sides, errors, 5.0)) == "< 10.0"


def test_an_error_that_rises_again_has_not_been_reached():
    sides, errors = np.array([10.0, 20, 40, 80]), np.array([4.0, 1, 2, 0.5])
    assert 40 < resolution_to_reach(sides, errors, 1.5).value < 80


def test_the_reference_needs_its_own_resolution():
    rows = [
        (DEFORMED, 1, 10.0, 0.4),
        (DEFORMED, 2, 20.0, 0.1),
        (UNDEFORMED, 1, 10.0, 0.4),
        (UNDEFORMED, 2, 20.0, 0.2),
    ]
    curves = pd.DataFrame(rows, columns=["representation", "cells", "resolution", "error"])
    summary = summarise(curves, reference_cells=2).set_index("representation")
    assert summary.loc[DEFORMED, "needed"] == "20.0"
    assert summary.loc[UNDEFORMED, "needed"] == "> 20.0"
    assert summary.loc[DEFORMED, "numbers"] == "32000"
    assert list(summary["needed_paper"]) == [41, 161]


def test_the_stage_writes_table_figure_and_data(tmp_path):
    options = ResolutionOptions.parse(TINY)
    measure_resolution(options, tmp_path / "table.csv", tmp_path / "figure.png")
    names = {"table.csv", "table.md", "figure.csv", "figure.png"}
    assert {path.name for path in tmp_path.iterdir()} == names
    table, curves = (pd.read_csv(tmp_path / name) for name in ("table.csv", "figure.csv"))
    assert list(table["representation"]) == [DEFORMED, UNDEFORMED, BINARY, BLOCKY, DISTANCE]
    assert len(curves) == 2 + 3 + 3 * 3
    again = measure_curves(Torus(**options.torus.model_dump()), options)
    assert list(curves["error"]) == list(again["error"])  # the same seed, the same figures
    text = (tmp_path / "table.md").read_text()
    assert "0.32" in text
    assert "161" in text
    assert np.asarray(Image.open(tmp_path / "figure.png").convert("L")).std() > 10


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"reference_cells": 9}, "reference_cells"),
        ({"torus": {"major": 0.4, "minor": 0.2}}, "below 0.5"),
        ({"torus": {"major": 0.1, "minor": 0.2}}, "less than major"),
        ({"torus": {"axis": [0, 0, 0]}}, "direction"),
    ],
)
def test_impossible_options_are_named(values, words):
    with pytest.raises(UserError, match=words):
        ResolutionOptions.parse(values)
