"""Captions, Markdown, pictures within a budget, provenance."""

import io
import subprocess
from pathlib import Path

import numpy as np
import pytest
from made_up import write_text
from PIL import Image

from tetgan.errors import UserError
from tetgan.report.figures import fit_pictures, read_figures
from tetgan.report.markup import cell_text, markdown_html, read_caption, table_html
from tetgan.report.provenance import (
    code_commit,
    machine,
    package_versions,
    seeds_of,
    stage_times,
    training_devices,
)
from tetgan.report.tables import read_tables


def noise(width, height, seed=0):
    picture = np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)
    into = io.BytesIO()
    Image.fromarray(picture).save(into, "PNG")
    return into.getvalue()


def test_asides_of_a_cell_are_set_apart():
    assert cell_text("1 ± 2 [0.5, 1e-3] (paper 3)") == (
        '1 ± 2 <span class="interval">[0.5, 1e-3]</span> <span class="paper">(paper 3)</span>'
    )
    assert cell_text("[x, y] (papers) <b>") == "[x, y] (papers) &lt;b&gt;"


@pytest.mark.parametrize(
    ("cell", "number"),
    [
        ("0.25", True),
        ("-3", True),
        ("1.2e-05", True),
        ("747 ± 240 [385, 1234]", True),
        ("—", True),
        ("12 (paper 13)", True),
        ("1-of-16", False),
        ("3x", False),
        ("LR", False),
        ("", False),
    ],
)
def test_numbers_stand_on_the_right(cell, number):
    assert ('<td class="number">' in table_html(["a"], [[cell]])) == number


def test_a_table_without_rows_keeps_its_header():
    assert "<th>a</th><th>b</th>" in table_html(["a", "b"], [])


def test_versions_are_no_numbers():
    assert "number" not in table_html(["a"], [["1.2"]], numbers=False)


def test_columns_of_the_paper_are_grey():
    html = table_html(["model", "Paper", "fid_paper", "Other than the paper's"], [["a", "x", "1", "b"]])
    assert html.count('class="paper"') == 2
    assert '<td class="number paper">1</td>' in html


def test_markdown_makes_no_tags_links_or_pictures_of_its_own():
    html = markdown_html(
        "# T\n\n<b>x</b> [a](http://b) ![c](d) <http://e>\n\n<div>\n\n## S\n\n[r]: http://f\n"
    )
    assert "<a" not in html and "<img" not in html and "<b>" not in html and "<div" not in html
    assert "T" not in html
    assert "<h4>S</h4>" in html


def test_cells_of_markdown_keep_their_emphasis():
    html = markdown_html("| a | b |\n|--|--|\n| **1** | `x` |\n")
    assert '<td class="number"><strong>1</strong></td><td><code>x</code></td>' in html


def test_a_caption_is_a_template_of_the_job(captions, tmp_path):
    wildcards = {"category": "vase"}
    assert read_caption(captions, ["absent", "table"], wildcards, {}) == (
        "<p>Rows of vase &amp; <code>reduced</code>.</p>\n"
    )
    assert read_caption(captions, ["absent"], wildcards, {}) == ""
    assert read_caption(None, ["table"], wildcards, {}) == ""
    (tmp_path / "bad.rst").write_text("{{ snakemake.")
    with pytest.raises(UserError, match=r"bad\.rst"):
        read_caption(tmp_path, ["bad"], wildcards, {})


def test_pictures_within_the_budget_are_left_alone():
    pictures = {Path("a"): noise(20, 20), Path("b"): noise(60, 60)}
    assert fit_pictures(pictures, sum(map(len, pictures.values()))) == pictures


def test_the_largest_pictures_are_reduced_to_the_budget():
    small, large, other = Path("small"), Path("large"), Path("other")
    pictures = {small: noise(40, 40), large: noise(900, 300), other: noise(800, 400, seed=1)}
    budget = 350_000
    fitted = fit_pictures(pictures, budget)
    assert fitted[small] is pictures[small]
    assert sum(map(len, fitted.values())) <= budget
    for name in (large, other):
        width, height = Image.open(io.BytesIO(fitted[name])).size
        before = Image.open(io.BytesIO(pictures[name])).size
        assert width / height == pytest.approx(before[0] / before[1], rel=0.01)


def test_a_reduced_figure_says_so(results):
    figures = read_figures(results, ["chair"], None, {}, budget=6000)
    assert [figure.category for figure in figures] == ["chair", "chair", ""]
    assert any(figure.reduced for figure in figures)


def test_a_file_that_is_no_picture_is_named(tmp_path):
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures/broken.png").write_bytes(b"nothing")
    with pytest.raises(UserError, match=r"broken\.png"):
        read_figures(tmp_path, [], None, {})


def test_a_wide_table_without_a_twin_shows_its_first_columns(tmp_path):
    (tmp_path / "tables").mkdir()
    names = [f"c{number}" for number in range(20)]
    (tmp_path / "tables/wide.csv").write_text(",".join(names) + "\n" + ",".join("1" * 20) + "\n")
    (table,) = read_tables(tmp_path, [], None, {})
    assert "c11" in table.html and "c12" not in table.html
    assert "8 more columns" in table.html


def test_seeds_are_found_at_every_depth():
    config = {"seeds": [0, 1], "split": {"seed": 3}, "sources": {"a": {"seed": 4, "count": 2}}, "none": None}
    assert seeds_of(config) == {"seeds": "0, 1", "split.seed": "3", "sources.a.seed": "4"}


def test_times_are_summed_by_stage(results):
    times = stage_times(results / "benchmarks")
    assert times["stage"].tolist() == ["train", "repair_shapes"]
    assert times["jobs"].tolist() == [1, 2]
    np.testing.assert_allclose(times["minutes"], [10, 2])
    np.testing.assert_allclose(times["longest"], [10, 1.5])
    np.testing.assert_allclose(times["peak"], [np.nan, 123.4])


def test_no_benchmarks_give_an_empty_table(tmp_path):
    assert stage_times(tmp_path / "absent").empty


def test_a_file_that_is_no_benchmark_is_named(tmp_path):
    for content in ("", "a\tb\n1\t2\n"):
        (tmp_path / "stage.tsv").write_text(content)
        with pytest.raises(UserError, match=r"stage\.tsv: not a benchmark"):
            stage_times(tmp_path)


def test_devices_of_training_are_those_that_models_recorded(tmp_path):
    for name, content in (("a/0", '{"device": "cpu"}'), ("a/1", '{"device": "H100"}'), ("b/0", "{}")):
        write_text(tmp_path / "models/chair" / name / "options.json", content)
    write_text(tmp_path / "extractor/options.json", '{"device": "A40"}')
    found = training_devices(tmp_path)
    assert found == {"extractor": "A40", "chair/a/0": "cpu", "chair/a/1": "H100", "chair/b/0": ""}
    assert training_devices(tmp_path / "absent") == {}
    write_text(tmp_path / "models/chair/c/0/options.json", "cut o")
    with pytest.raises(UserError, match=r"c/0/options\.json: not the options"):
        training_devices(tmp_path)


def test_versions_and_machine_are_known():
    versions = package_versions()
    assert versions["numpy"] == np.__version__
    assert "ruff" not in versions
    assert all(machine().values())


def test_the_commit_is_that_of_a_checkout_and_of_no_other(tmp_path):
    def git(*arguments):
        who = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
        subprocess.run(["git", "-C", str(tmp_path), *who, *arguments], check=True, capture_output=True)

    assert code_commit(tmp_path) == "not a git checkout"
    git("init")
    (tmp_path / "__init__.py").write_text("")
    assert code_commit(tmp_path) == "not a git checkout"
    git("add", "__init__.py")
    git("commit", "-m", "one")
    commit = code_commit(tmp_path)
    assert len(commit) == 40
    (tmp_path / "__init__.py").write_text("x = 1\n")
    assert code_commit(tmp_path) == f"{commit} with uncommitted changes"
