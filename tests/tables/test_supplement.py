"""The supplement's three tables: columns for categories, seeds, the paper's figures, and what is missing."""

import pytest

from tetgan.errors import UserError
from tetgan.tables.supplement import IDENTITY, tabulate_supplement


@pytest.fixture
def supplement(tmp_path, paper, write, read):
    def make(reports, figure="fid"):
        tabulate_supplement(write(reports), paper, figure, tmp_path / "table.csv")
        return read(tmp_path / "table.csv")

    return make


CATEGORIES = ("bench", "sofa", "table", "vase")  # the paper's


def cells(table, row: int, category: str) -> list[str]:
    parts = ("", "_std", "_low", "_high", "_paper", "_n", "_seeds")
    return [table.iloc[row][category + part] for part in parts]


def test_columns_are_identity_then_seven_a_category_of_the_paper(supplement, report):
    table, _ = supplement([report("bench", "tetgan-HR", fid=(4, 3, 5, None, 64))])
    parts = ("", "_std", "_low", "_high", "_n", "_paper", "_seeds")
    assert list(table.columns) == [*IDENTITY, *(c + part for c in CATEGORIES for part in parts)]


def test_each_category_has_its_own_cells_and_the_papers_figure(supplement, report):
    table, text = supplement(
        [
            report("bench", "tetgan-HR", fid=(4, 3, 5, None, 64)),
            report("vase", "tetgan-HR", fid=(8, 7, 9, None, 50)),
            report("vase", "tetgan-LR", fid=(6, 5, 7, None, 50)),
        ]
    )
    assert list(table["model"]) == ["tetgan-HR", "tetgan-LR"]
    assert cells(table, 0, "bench") == ["4.0", "", "3.0", "5.0", "2.67", "64", "1"]
    assert cells(table, 0, "vase") == ["8.0", "", "7.0", "9.0", "2.57", "50", "1"]
    # The paper's vases are of high resolution: nothing is beside the LR row.
    assert cells(table, 1, "vase") == ["6.0", "", "5.0", "7.0", "", "50", "1"]
    assert "4 [3, 5] (paper 2.67)" in text


def test_the_method_and_grid_give_a_row_its_printed_figures(supplement, report):
    mine = report("vase", "my-net", method="tetgan", fid=(8,)) | {"grid": "HR"}
    other = report("vase", "tetgan-HR", method="pca", fid=(8,))
    table, _ = supplement([mine, other])
    assert dict(zip(table["model"], table["vase_paper"], strict=True)) == {"my-net": "2.57", "tetgan-HR": ""}


def test_categories_without_a_figure_in_the_supplement_follow_the_papers(supplement, report):
    reports = [
        report("lamp", "tetgan-LR", fid=(5, 4, 6, None, 30), notes=["FID is biased"]),
        report("chair", "tetgan-LR", fid=(3,)),
    ]
    table, text = supplement(reports)
    assert [name for name in table if f"{name}_seeds" in table] == [*CATEGORIES, "lamp", "chair"]
    assert cells(table, 0, "lamp") == ["5.0", "", "4.0", "6.0", "", "30", "1"]
    assert cells(table, 0, "chair")[0] == "3.0"
    assert cells(table, 0, "chair")[4] == "2.09"  # of Table 1
    assert "- lamp: FID is biased. (all rows)" in text
    assert "Not run: bench, sofa, table, vase." in text


def test_a_category_that_was_not_run_is_empty_but_for_the_papers_figure(supplement, report):
    table, text = supplement([report("chair", "tetgan-LR", fid=(4,)), report("chair", "real", fid=(1,))])
    assert cells(table, 0, "sofa") == ["", "", "", "", "3.35", "", ""]
    assert cells(table, 0, "bench") == [""] * 7
    assert cells(table, 1, "sofa") == [""] * 7
    assert "— (paper 3.35)" in text
    assert "Not run: bench, sofa, table, vase." in text
    assert "0" not in {cell for category in CATEGORIES for cell in cells(table, 0, category)}


def test_several_seeds_give_their_mean_and_deviation(supplement, report):
    reports = [
        report("sofa", "tetgan-LR", seed, variety=(value, value - 1, value + 1, 9, 7))
        for seed, value in enumerate((2, 4))
    ]
    table, _ = supplement(reports, "variety")
    value, std, low, high, printed, n, seeds = cells(table, 0, "sofa")
    assert [float(cell) for cell in (value, std, low, high)] == pytest.approx([3, 2**0.5, 2, 4])
    assert (printed, n, seeds) == ("0.0017", "7", "2")


def test_a_seed_without_the_figure_is_not_counted(supplement, report):
    reports = [report("sofa", "tetgan-LR", 0, fid=(2, 1, 3, None, 64)), report("sofa", "tetgan-LR", 1)]
    table, _ = supplement(reports)
    assert cells(table, 0, "sofa")[0] == "2.0"
    assert cells(table, 0, "sofa")[-2:] == ["64", "1"]


def test_reconstruction_is_the_chamfer_distance(supplement, report):
    table, _ = supplement([report("table", "tetgan-LR", chamfer=(0.5,))], "reconstruction")
    assert cells(table, 0, "table")[0] == "0.5"
    assert cells(table, 0, "table")[4] == "0.0029"


def test_notes_name_the_extractor_and_remarks_on_the_figure(supplement, report):
    notes = ["FID at N = 4, below 768, is mostly bias", "variety needs 7 surfaces and has 5"]
    _, text = supplement([report("bench", "tetgan-HR", notes=notes)])
    assert "- bench: FID at N = 4, below 768, is mostly bias." in text
    assert "variety needs" not in text
    assert "Extractor abc: PointNet++ on bench, vase" in text


def test_a_figure_that_is_none_and_files_that_are_not_metrics_are_refused(
    supplement, report, tmp_path, paper
):
    with pytest.raises(UserError, match="choose one of fid, variety, reconstruction"):
        supplement([report("bench", "tetgan-HR")], "beauty")
    with pytest.raises(UserError, match="no metrics"):
        supplement([])
    for content in ("[]", "{}", "model,value"):
        (tmp_path / "bad.json").write_text(content)
        with pytest.raises(UserError, match=r"bad\.json: not metrics"):
            tabulate_supplement([tmp_path / "bad.json"], paper, "fid", tmp_path / "table.csv")
