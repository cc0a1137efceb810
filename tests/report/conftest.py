"""Made-up results, captions, and their page."""

import numpy as np
import pytest
from made_up import CONFIG, write_results

from tetgan.grids.hierarchy import build_hierarchy
from tetgan.report.page import report_page


@pytest.fixture(scope="session")
def ball():
    """Vertices and tets of a ball cut out of a grid."""
    grid = build_hierarchy(1, 2).finest
    inside = np.linalg.norm(grid.vertices[grid.tets].mean(axis=1) - 0.5, axis=1) < 0.4
    return grid.vertices, grid.tets[inside]


@pytest.fixture(scope="session")
def results(tmp_path_factory, ball):
    folder = tmp_path_factory.mktemp("results")
    write_results(folder, *ball)
    return folder


@pytest.fixture(scope="session")
def captions(tmp_path_factory):
    folder = tmp_path_factory.mktemp("captions")
    (folder / "table.rst").write_text("Rows of {{ snakemake.wildcards.category }} & ``reduced``.\n")
    (folder / "interpolation.rst").write_text("Between two {{ snakemake.wildcards.category }}s.\n")
    return folder


@pytest.fixture(scope="session")
def page(results, captions, tmp_path_factory):
    out = tmp_path_factory.mktemp("page") / "report.html"
    report_page(results, out, config=CONFIG, captions=captions)
    return out
